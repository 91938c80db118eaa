// Reads the bit-plane store back, 32 bits at a time, through the store's low-priority port.
//
// A new address starts reading there; each request is answered with the next 32 bits, as soon as they are here. The word
// after the last one handed out is read ahead. Addresses past the store, and requests before any address, read as zero.
//
// Latency    : request to answer 1 clock when the bits are here.
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
    input  logic                 request_i,     // pulse; none while one is unanswered
    output logic                 answer_o,      // pulse
    output logic [31:0]          data_o,        // 0 unless answer_o
    output logic                 peek_valid_o,
    input  logic                 peek_ready_i,
    output logic [AddrW-1:0]     peek_addr_o,
    input  logic                 peek_done_i,
    input  logic [GroupBits-1:0] peek_data_i
);
  localparam int unsigned Chunks = (GroupBits + 31) / 32;
  localparam int unsigned ChunkW = (Chunks > 1) ? $clog2(Chunks) : 1;

  logic [Chunks*32-1:0] word_q;
  logic [ChunkW-1:0] chunk_q;
  logic [23:0] address_q;
  logic want_q;      // address_q is to be read
  logic flight_q;    // a read is on its way
  logic drop_q;      // ... and no longer wanted
  logic have_q;      // word_q is the word before address_q
  logic waiting_q;   // a request waits
  logic answer_q;
  logic [31:0] data_q;
  logic in_store, idle, answer, last;

  assign in_store = address_q < 24'(StoreWords);
  assign idle   = !want_q && !flight_q && !have_q;
  assign answer = (request_i || waiting_q) && (have_q || idle) && !go_i;
  assign last   = chunk_q == ChunkW'(Chunks - 1);

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      want_q    <= 1'b0;
      flight_q  <= 1'b0;
      drop_q    <= 1'b0;
      have_q    <= 1'b0;
      waiting_q <= 1'b0;
      answer_q  <= 1'b0;
    end else begin
      answer_q  <= answer;
      waiting_q <= (request_i || waiting_q) && !answer;
      if (peek_valid_o && peek_ready_i) begin
        want_q   <= 1'b0;
        flight_q <= 1'b1;
      end else if (want_q && !in_store && !flight_q) begin
        want_q <= 1'b0;
        have_q <= 1'b1;
      end
      if (peek_done_i) begin
        flight_q <= 1'b0;
        drop_q   <= 1'b0;
        have_q   <= !drop_q;
      end
      if (answer && have_q && last) begin
        have_q <= 1'b0;
        want_q <= 1'b1;
      end
      if (go_i) begin
        want_q <= 1'b1;
        have_q <= 1'b0;
        drop_q <= (flight_q && !peek_done_i) || (peek_valid_o && peek_ready_i);
      end
    end
  end

  always_ff @(posedge clk_i) begin
    if (peek_done_i) word_q <= (Chunks * 32)'(peek_data_i);
    else if (want_q && !in_store && !flight_q) word_q <= '0;
    else if (answer) word_q <= word_q >> 32;
    if (answer) chunk_q <= last ? '0 : chunk_q + 1'b1;
    if (answer && have_q && last) address_q <= address_q + 1'b1;
    if (go_i) begin
      address_q <= address_i;
      chunk_q   <= '0;
    end
    data_q <= (answer && have_q) ? word_q[31:0] : '0;
  end

  assign peek_valid_o = want_q && in_store && !flight_q;
  assign peek_addr_o  = address_q[AddrW-1:0];
  assign answer_o     = answer_q;
  assign data_o       = data_q;

  `SLOG_ASSERT(SlogPeekOneRequest, request_i |-> !waiting_q)
  `SLOG_ASSERT(SlogPeekDoneExpected, peek_done_i |-> flight_q)
endmodule : slog_peek
