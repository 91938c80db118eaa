# SPDX-License-Identifier: Apache-2.0
"""Tests of `examples/`: every example runs, and prints what is true."""
