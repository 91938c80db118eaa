"""Shared test-bench parts: the cycle checker, stall shapes."""
