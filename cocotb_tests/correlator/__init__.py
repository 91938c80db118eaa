# SPDX-License-Identifier: Apache-2.0
"""Tests of the correlator and of its parts from grid to walker."""
