// SPDX-License-Identifier: Apache-2.0
// For `verilator -F files.f`: paths are relative to this file. The waivers name the reason of each.
../../rtl/slog_waive.vlt
+incdir+../../rtl
../../rtl/cells/slog_ram.sv
../../rtl/cells/slog_mult.sv
../../rtl/frontend/slog_video_in.sv
../../rtl/frontend/slog_line_bank.sv
../../rtl/frontend/slog_line_buffer.sv
../../rtl/frontend/slog_fir_tree.sv
../../rtl/frontend/slog_fir_kernel.sv
../../rtl/frontend/slog_fir.sv
../../rtl/frontend/slog_taps_slice.sv
../../rtl/frontend/slog_taps_window.sv
../../rtl/frontend/slog_taps.sv
../../rtl/frontend/slog_log.sv
../../rtl/frontend/slog_packer_slice.sv
../../rtl/frontend/slog_packer.sv
../../rtl/frontend/slog_frontend.sv
my_design.sv
