"""Tests of `examples/`: every example runs, and prints what is true."""
