# SPDX-License-Identifier: Apache-2.0
"""The Verilated board: its build, its C interface, the register driver, and both from Python."""
