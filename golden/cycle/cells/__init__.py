"""Cycle models of the general cells: RAM, multiplier, queues and the register stage."""
