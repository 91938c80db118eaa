# SPDX-License-Identifier: Apache-2.0
"""Parts of every test bench: the cycle checker, a host of the board, an AXI4-Lite master, the parameters."""
