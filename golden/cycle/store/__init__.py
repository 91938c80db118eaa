# SPDX-License-Identifier: Apache-2.0
"""Cycle models of the bit-plane store and of the captures that fill it."""
