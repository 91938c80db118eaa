"""Flows around the RTL: the Verilated board, cocotb runs, registers, lint, synthesis and speeds."""
