"""Proofs about the RTL with SymbiYosys and yices."""
