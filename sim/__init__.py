"""Builds and runs the RTL: the cocotb runner and the Verilated board."""
