// SPDX-License-Identifier: Apache-2.0
// Timing of slog_store.
package slog_store_pkg;
  // Clocks from rd_valid_i to rd_data_o: request 1, slice inputs 2, bank 1, block RAM and its output register 2, bank output
  // 1, bank multiplexer 1, output registers 2.
  localparam int unsigned StoreLatency = 10;
endpackage : slog_store_pkg
