// Timing of slog_store.
package slog_store_pkg;
  // rd_valid_i to rd_data_o: request, slice 2, bank, block RAM, its output register, hop, bank multiplexer, hop 2.
  localparam int unsigned StoreLatency = 10;
endpackage : slog_store_pkg
