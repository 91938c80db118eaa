# SPDX-License-Identifier: Apache-2.0
"""Cycle models of the general cells: RAM, multiplier, queues and the register stage."""
