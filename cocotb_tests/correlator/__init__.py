"""Tests of the correlator and of its parts from grid to walker."""
