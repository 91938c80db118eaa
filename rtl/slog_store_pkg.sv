// Timing of slog_store.
package slog_store_pkg;
  // rd_valid_i to rd_data_o: request, slice, bank, block RAM, its output register, bank multiplexer.
  localparam int unsigned StoreLatency = 6;
endpackage : slog_store_pkg
