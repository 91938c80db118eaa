# SPDX-License-Identifier: Apache-2.0
"""Calibration of a camera, or of a stereo pair, from views of a board whose corners are known."""
