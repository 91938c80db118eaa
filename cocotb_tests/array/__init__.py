"""Tests of the correlator array and its operands."""
