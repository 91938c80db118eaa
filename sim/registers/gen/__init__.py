"""Generated from rtl/slog_csr.rdl by `python -m sim.regs`."""
