// Reads the bit-plane store back, 32 bits at a time, through the store's low-priority port.
//
// A new address starts reading there; data_o is what the next read gets, and each read moves on. The word after the last
// one handed out is read ahead. Addresses past the store, and reads before any address, give zero.
//
// The store is far, and what it shows reaches over the die: it comes on plain registers, the second 32 bits a clock after
// the first, so that no enable serves all of it.
//
// Latency    : go_i to peek_valid_o 5 clocks; ready_o falls 1 clock after go_i, 2 clocks after the take_i of a word's last
//              32 bits, and comes 2 clocks after peek_done_i; data_o follows it by Chunks + 1 clocks, a take_i by 2.
// Rule       : address_i stays for 3 clocks from go_i on.
// Formats    : bit 0 is the leftmost pixel; a store word narrower than 32 bits fills the low bits.
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
    input  logic                 take_i,        // pulse, only if ready_o: data_o was read
    output logic                 ready_o,       // data_o is right soon: before a read that waited for this comes to it
    output logic [31:0]          data_o,
    output logic                 peek_valid_o,
    input  logic                 peek_ready_i,
    output logic [AddrW-1:0]     peek_addr_o,
    input  logic                 peek_done_i,
    input  logic [GroupBits-1:0] peek_data_i
);
  localparam int unsigned Chunks = (GroupBits + 31) / 32;
  localparam int unsigned ChunkW = (Chunks > 1) ? $clog2(Chunks) : 1;

  logic [Chunks-1:0][31:0] shown;  // what the store shows
  logic [Chunks-1:0][31:0] word_q;
  logic [Chunks-1:0] load_q;       // [c]: bits 32 * c .. of it are taken, which were shown c + 2 clocks before
  logic [ChunkW-1:0] chunk_q;      // of word_q, the next to be read
  logic [31:0] data_q;
  logic [23:0] address_q;
  logic go_q;
  logic started_q;   // there is an address
  logic first_q;     // the address that comes is the host's
  logic new_q;       // address_q changes
  logic new_q2;      // ... and has
  logic in_store_q;  // address_q lies in the store
  logic want_q;      // address_q is to be read
  logic valid_q;     // ... and asked for
  logic outside_q;   // ... and not in the store
  logic flight_q;    // a read is on its way
  logic done_q;      // ... and its word was shown
  logic drop_q;      // ... and no longer wanted
  logic have_q;      // word_q is the word before address_q, or none was ever asked for
  logic zero_q;      // in its place stands 0
  logic onward_q;    // the last of word_q was read
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

  `SLOG_ASSERT(SlogPeekReady, take_i || onward_q |-> have_q && !go_i && !go_q)
  `SLOG_ASSERT(SlogPeekAddressStays, go_q || (new_q && first_q) |-> $stable(address_i))
  `SLOG_ASSERT(SlogPeekOneNew, new_q || new_q2 |-> !go_q && !onward_q)
  `SLOG_ASSERT(SlogPeekDoneExpected, peek_done_i |-> flight_q)
endmodule : slog_peek
