"""Tests of the general cells: RAM, multiplier, queues."""
