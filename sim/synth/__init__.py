"""Synthesis, place and route for the Lattice ECP5."""
