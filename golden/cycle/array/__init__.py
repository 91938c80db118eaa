# SPDX-License-Identifier: Apache-2.0
"""Cycle models of the correlator array: its operands and the counting, with their common timing."""
