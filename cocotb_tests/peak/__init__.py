# SPDX-License-Identifier: Apache-2.0
"""Tests of the peak unit and its parts."""
