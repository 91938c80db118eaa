// SPDX-License-Identifier: Apache-2.0
// Timing and banks of slog_store, and what slog_capture tells of a frame on its way into it.
package slog_store_pkg;
  // Clocks from rd_valid_i to rd_data_o: request 1, slice inputs 2, bank 1, block RAM and its output register 2, bank output
  // 1, bank multiplexer 1, output registers 2.
  localparam int unsigned StoreLatency = 10;

  // A bank is a block RAM deep. Behind whole banks, words fill block RAMs of half and of a quarter of the depth, which are
  // two and four times as wide: 28800 words of 64 bits take 120 of them, and two whole banks would take 128.
  // Words of the next bank, of `left` ones behind others, or of `left` in all.
  function automatic int unsigned next_bank(int unsigned left, int unsigned bank, bit first);
    if (left >= bank) return bank;
    if (first) return left;
    return (left > bank / 2) ? bank / 2 : (left > bank / 4) ? bank / 4 : left;
  endfunction

  // First word of bank b; of the one behind the last: `words`.
  function automatic int unsigned bank_start(int unsigned words, int unsigned bank, int unsigned b);
    int unsigned start = 0;
    for (int unsigned k = 0; k < b; k++) start += next_bank(words - start, bank, k == 0);
    return start;
  endfunction

  function automatic int unsigned bank_depth(int unsigned words, int unsigned bank, int unsigned b);
    return bank_start(words, bank, b + 1) - bank_start(words, bank, b);
  endfunction

  function automatic int unsigned bank_count(int unsigned words, int unsigned bank);
    int unsigned b = 1;
    while (bank_start(words, bank, b) < words) b++;
    return b;
  endfunction

  // Addresses that choose a bank differ from its first word's in fewer bits than this.
  function automatic int unsigned bank_bits(int unsigned depth, int unsigned bank);
    return $clog2((depth > bank / 2) ? bank : (depth > bank / 4) ? bank / 2 : bank / 4);
  endfunction

  // One camera's capture. A frame that is begun either becomes whole (done) or is lost: writing falls without it.
  typedef struct packed {
    logic       held;     // a request waits for its frame, or is being served
    logic       writing;  // held, and the frame's words are being written; until then nothing in the slot changes
    logic       done;     // pulse in the last clock of writing and of held: the slot holds the whole frame
    logic [2:0] slot;     // while held, else 0
    logic [9:0] rows;     // while writing: rows of the frame whose words may be read, with rd_valid_i from 4 clocks on
  } progress_t;
endpackage : slog_store_pkg
