# SPDX-License-Identifier: Apache-2.0
"""Geometry: similarities of the plane, camera calibration, and how a camera is turned."""
