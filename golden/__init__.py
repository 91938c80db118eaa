"""The executable specification of the board: integer NumPy, no simulator."""
