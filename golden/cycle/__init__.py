"""Cycle models: one a file, in the rooms of `rtl/`, named after its module without `slog_`; `board.py` joins them."""
