# SPDX-License-Identifier: Apache-2.0
"""Proofs about the RTL with SymbiYosys and yices."""
