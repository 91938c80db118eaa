# SPDX-License-Identifier: Apache-2.0
"""Flows around the RTL: the Verilated board, cocotb runs, registers, lint, synthesis and speeds."""
