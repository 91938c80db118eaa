"""Tests of the registers, by clock and by field."""
