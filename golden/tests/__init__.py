# SPDX-License-Identifier: Apache-2.0
"""Tests of the specification: the frame level against brute force, the cycle models against the frame level."""
