# SPDX-License-Identifier: Apache-2.0
"""Generated from rtl/control/slog_csr.rdl by `python -m sim.registers`."""
