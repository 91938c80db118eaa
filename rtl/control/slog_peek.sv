// SPDX-License-Identifier: Apache-2.0
// Reads the bit-plane store back, 32 bits at a time, through the store's low-priority port.
//
// Reading starts at a new address; data_o is the value of the next read, and each read advances. The word after the current
// one is read ahead. Addresses past the store, and reads before the first address, give zero.
//
// The store lies far away and its output spans the die: it passes through pipeline registers, the second 32 bits one clock
// after the first, so that no single enable drives all of them.
//
// Latency    : go_i to peek_valid_o 5 clocks; ready_o falls 1 clock after go_i, 2 clocks after the take_i of a word's last
//              32 bits, and rises 2 clocks after peek_done_i; data_o follows it by Chunks + 1 clocks, a take_i by 2.
// Rule       : address_i is constant for 3 clocks from go_i on.
// Captures   : a word of a slot that is being written is the old or the new one; if its write leaves for the store in the
//              clock before its read, it is undefined. Reading advances as always.
// Formats    : bit 0 is the leftmost pixel; a store word narrower than 32 bits fills the low bits.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_peek #(
    parameter  int unsigned GroupBits  = 64,
    parameter  int unsigned StoreWords = 28800,
    localparam int unsigned AddrW      = $clog2(StoreWords)
) (
    input  logic                 clk_i,
    input  logic                 rst_i,
    input  logic                 go_i,
    input  logic [23:0]          address_i,
    input  logic                 take_i,        // pulse, only with ready_o: data_o is read
    output logic                 ready_o,       // data_o is valid by the time a read that waited for ready_o samples it
    output logic [31:0]          data_o,
    output logic                 peek_valid_o,
    input  logic                 peek_ready_i,
    output logic [AddrW-1:0]     peek_addr_o,
    input  logic                 peek_done_i,
    input  logic [GroupBits-1:0] peek_data_i
);
  localparam int unsigned Chunks = (GroupBits + 31) / 32;
  localparam int unsigned ChunkW = (Chunks > 1) ? $clog2(Chunks) : 1;

  logic [Chunks-1:0][31:0] shown;  // the store's output
  logic [Chunks-1:0][31:0] word_q;
  logic [Chunks-1:0] load_q;       // [c]: bits 32 * c and up are loaded, which the store output c + 2 clocks before
  logic [ChunkW-1:0] chunk_q;      // the part of word_q that the next read gets
  logic [31:0] data_q;
  logic [23:0] address_q;
  logic go_q;
  logic started_q;   // an address was set
  logic first_q;     // the next address is the host's
  logic new_q;       // address_q changes with this clock's edge
  logic new_q2;      // address_q changed in the clock before
  logic in_store_q;  // address_q lies in the store
  logic want_q;      // address_q must be read
  logic valid_q;     // a read of address_q is requested
  logic outside_q;   // address_q must be read and lies outside the store
  logic flight_q;    // a read is in progress
  logic done_q;      // the store output its word in the clock before
  logic drop_q;      // its word is to be discarded
  logic have_q;      // word_q is valid: the word at address_q, or zero before the first address
  logic zero_q;      // data_o is 0 instead of word_q
  logic onward_q;    // the last part of word_q was read
  logic ask, taken;

  assign ask   = want_q && !flight_q && !valid_q;
  assign taken = valid_q && peek_ready_i;

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      go_q      <= 1'b0;
      started_q <= 1'b0;
      onward_q  <= 1'b0;
      new_q     <= 1'b0;
      new_q2    <= 1'b0;
      want_q    <= 1'b0;
      valid_q   <= 1'b0;
      outside_q <= 1'b0;
      flight_q  <= 1'b0;
      done_q    <= 1'b0;
      load_q    <= '0;
      drop_q    <= 1'b0;
      have_q    <= 1'b1;
      zero_q    <= 1'b1;
    end else begin
      go_q      <= go_i;
      onward_q  <= take_i && started_q && chunk_q == ChunkW'(Chunks - 1);
      new_q     <= go_q || onward_q;
      new_q2    <= new_q;
      done_q    <= peek_done_i;
      for (int unsigned c = 0; c < Chunks; c++) load_q[c] <= (c == 0) ? done_q : load_q[(c==0)?0 : c-1];
      valid_q   <= !go_q && ((ask && in_store_q) || (valid_q && !peek_ready_i));
      outside_q <= !go_q && ask && !in_store_q;
      if (new_q2) want_q <= 1'b1;
      else if (ask) want_q <= 1'b0;
      if (taken) flight_q <= 1'b1;
      else if (done_q) flight_q <= 1'b0;
      if (outside_q) begin
        have_q <= 1'b1;
        zero_q <= 1'b1;
      end
      if (done_q) begin
        drop_q <= 1'b0;
        have_q <= !drop_q;
        zero_q <= 1'b0;
      end
      if (onward_q) have_q <= 1'b0;
      if (go_q) begin
        started_q <= 1'b1;
        want_q    <= 1'b0;
        have_q    <= 1'b0;
        drop_q    <= (flight_q && !done_q) || taken;
      end
    end
  end

  always_ff @(posedge clk_i) begin
    data_q <= zero_q ? '0 : word_q[(Chunks>1)?chunk_q : '0];
    if (onward_q || go_q) chunk_q <= '0;
    else if (take_i) chunk_q <= chunk_q + 1'b1;
    first_q <= go_q;
    if (new_q) address_q <= first_q ? address_i : address_q + 1'b1;
    in_store_q <= address_q < 24'(StoreWords);
  end

  assign shown = (Chunks * 32)'(peek_data_i);
  for (genvar c = 0; c < Chunks; c++) begin : g_chunk
    logic [31:0] way_q[c+2];
    always_ff @(posedge clk_i) begin
      for (int unsigned n = 0; n < c + 2; n++) way_q[n] <= (n == 0) ? shown[c] : way_q[(n==0)?0 : n-1];
      if (load_q[c]) word_q[c] <= way_q[c+1];
    end
  end

  assign peek_valid_o = valid_q;
  assign peek_addr_o  = address_q[AddrW-1:0];
  assign ready_o      = have_q && !go_q;
  assign data_o       = data_q;

  `SLOG_ASSERT(SlogPeekReady, !(take_i || onward_q) || (have_q && !go_i && !go_q))
  `SLOG_PAST(past_address, address_i)
  `SLOG_ASSERT(SlogPeekAddressStays, !(go_q || (new_q && first_q)) || address_i == past_address)
  `SLOG_ASSERT(SlogPeekOneNew, !(new_q || new_q2) || (!go_q && !onward_q))
  `SLOG_ASSERT(SlogPeekDoneExpected, !peek_done_i || flight_q)
endmodule : slog_peek
