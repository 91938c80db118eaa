"""Cycle-by-cycle cosimulation of every RTL module against its golden model."""
