# SPDX-License-Identifier: Apache-2.0
"""Cycle models: one a block, in the rooms of `rtl/`, named after its module without `slog_`; `board.py` joins them.

Submodules without a file are modelled with their parent.
"""
