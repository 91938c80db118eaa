# SPDX-License-Identifier: Apache-2.0
"""Measurement of the speeds of board, simulators and OpenCV."""
