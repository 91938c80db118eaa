# SPDX-License-Identifier: Apache-2.0
"""Mosaic navigation in the simulated world; the truth is recorded beside every measurement and used in none."""
