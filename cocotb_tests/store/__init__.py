# SPDX-License-Identifier: Apache-2.0
"""Tests of the bit-plane store and of the captures."""
