# SPDX-License-Identifier: Apache-2.0
"""Bars of a hover that holds and recovers, on rendered clips with their truth; `make hover`."""
