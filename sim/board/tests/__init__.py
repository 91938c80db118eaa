"""Tests of the Verilated board and of the register driver."""
