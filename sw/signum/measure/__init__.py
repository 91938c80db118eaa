"""Measurements between frames on a board: displacements, flow, stereo range, tracks and registrations."""
