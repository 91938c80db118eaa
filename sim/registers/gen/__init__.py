"""Generated from rtl/control/slog_csr.rdl by `python -m sim.registers`."""
