# SPDX-License-Identifier: Apache-2.0
"""Applications of the measurements: mosaics, mosaic navigation, station keeping, object following; and their PID."""
