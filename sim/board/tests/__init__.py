# SPDX-License-Identifier: Apache-2.0
"""Tests of the Verilated board and of the register driver."""
