# SPDX-License-Identifier: Apache-2.0
"""Cycle models of the control side: AXI4-Lite registers, filter coefficients, peek port, counters."""
