# SPDX-License-Identifier: Apache-2.0
"""Tests of the registers, by clock and by field."""
