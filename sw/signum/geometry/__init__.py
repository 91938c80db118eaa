"""Geometry: similarities of the plane, camera calibration, and how a camera is turned."""
