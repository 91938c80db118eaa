// SPDX-License-Identifier: Apache-2.0
// The wide dense engine, which no board has: sources beside those of rtl/files.f, paths within rtl/.
dense/wide/slog_dense_wide_pkg.sv
dense/wide/slog_dense_wide_lane.sv
dense/wide/slog_dense_wide_winner.sv
dense/wide/slog_dense_wide_group.sv
dense/wide/slog_dense_wide.sv
