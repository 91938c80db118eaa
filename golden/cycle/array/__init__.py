"""Cycle models of the correlator array: its operands and the counting, with their common timing."""
