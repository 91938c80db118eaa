# SPDX-License-Identifier: Apache-2.0
"""The simulated underwater world: seafloor, water, cameras, vehicle, fish. Deterministic for a seed.

Axes, everywhere in this package: world X north, Y east, Z down, metres; the mean seafloor is the plane Z = 0, and Z is
negative above it. Body axes are forward, right, down. Angles in radians, right-handed about those axes.
"""
