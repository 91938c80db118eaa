// Timing of slog_store.
package slog_store_pkg;
  // rd_valid_i to rd_data_o: request, hop, slice, bank, block RAM, its output register, hop, bank multiplexer, hop.
  localparam int unsigned StoreLatency = 9;
endpackage : slog_store_pkg
