"""Lint of the RTL, with the reason of each waiver."""
