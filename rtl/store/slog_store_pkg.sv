// SPDX-License-Identifier: Apache-2.0
// Timing of slog_store, and what slog_capture tells of a frame on its way into it.
package slog_store_pkg;
  // Clocks from rd_valid_i to rd_data_o: request 1, slice inputs 2, bank 1, block RAM and its output register 2, bank output
  // 1, bank multiplexer 1, output registers 2.
  localparam int unsigned StoreLatency = 10;

  // One camera's capture. A frame that is begun either becomes whole (done) or is lost: writing falls without it.
  typedef struct packed {
    logic       held;     // a request waits for its frame, or is being served
    logic       writing;  // held, and the frame's words are being written; until then nothing in the slot changes
    logic       done;     // pulse in the last clock of writing and of held: the slot holds the whole frame
    logic [2:0] slot;     // while held, else 0
    logic [9:0] rows;     // while writing: rows of the frame whose words may be read, with rd_valid_i from 4 clocks on
  } progress_t;
endpackage : slog_store_pkg
