# SPDX-License-Identifier: Apache-2.0
"""Synthesis, place and route for the Lattice ECP5."""
