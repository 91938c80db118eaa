"""Measurement of the speeds of board, simulators and OpenCV."""
