# SPDX-License-Identifier: Apache-2.0
"""The executable specification of the board: integer NumPy, no simulator."""
