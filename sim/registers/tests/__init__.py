"""Tests of the register generation."""
