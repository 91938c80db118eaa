"""Tests of the bit-plane store and of the captures."""
