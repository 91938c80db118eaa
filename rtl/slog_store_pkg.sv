// Timing of slog_store.
package slog_store_pkg;
  // rd_valid_i to rd_data_o: address register, block RAM, its output register, bank multiplexer.
  localparam int unsigned StoreLatency = 4;
endpackage : slog_store_pkg
