# SPDX-License-Identifier: Apache-2.0
"""The version: one for the package, the tags (`v1.1.0`) and the register block."""

VERSION = "1.1.0"
"""Its first two numbers are major and minor version of `rtl/control/slog_csr.rdl`, which a board reports."""
