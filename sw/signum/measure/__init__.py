# SPDX-License-Identifier: Apache-2.0
"""Measurements between frames on a board: displacements, flow, stereo range, tracks and registrations."""
