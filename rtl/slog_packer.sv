// Packs the sign bits of each row into words for the bit-plane store.
//
// Bit b of a row's word w is pixel w * GroupBits + b; a row's last word is filled up with zeros. word_data_o and
// word_last_o count only with word_valid_o.
//
// Latency    : 1 clock from a word's last pixel to word_valid_o; frame_start_o, _done_o, _abort_o follow 1 clock behind
//              the pixel (or gap) they come with: a frame's first word comes GroupBits - 1 clocks after frame_start_o.
// Throughput : one pixel per clock; the sink takes every word.
`include "slog_assert.svh"
module slog_packer #(
    parameter int unsigned GroupBits = 8
) (
    input  logic                 clk_i,
    input  logic                 rst_i,
    input  logic                 bit_valid_i,
    input  logic                 bit_i,
    input  logic                 bit_last_i,
    input  logic                 bit_start_i,
    input  logic                 bit_done_i,
    input  logic                 bit_abort_i,
    output logic                 word_valid_o,
    output logic [GroupBits-1:0] word_data_o,
    output logic                 word_last_o,
    output logic                 frame_start_o,
    output logic                 frame_done_o,
    output logic                 frame_abort_o
);
  logic [GroupBits-1:0] word_q;   // the word so far
  logic [GroupBits-1:0] place_q;  // one-hot: where the next pixel goes; not used for a word's first
  logic                 fresh_q;  // the next pixel is a word's first
  logic                 valid_q, last_q, start_q, done_q, abort_q;
  logic                 full;

  assign full = bit_last_i || (place_q[GroupBits-1] && !fresh_q);

  always_ff @(posedge clk_i) begin
    last_q <= bit_last_i;
    if (fresh_q) begin
      word_q  <= GroupBits'(bit_i);
      place_q <= GroupBits'(2);
    end else if (bit_valid_i) begin
      place_q <= place_q << 1;
      for (int unsigned b = 0; b < GroupBits; b++) if (place_q[b]) word_q[b] <= bit_i;
    end
    if (rst_i) begin
      fresh_q <= 1'b1;
      valid_q <= 1'b0;
      start_q <= 1'b0;
      done_q  <= 1'b0;
      abort_q <= 1'b0;
    end else begin
      fresh_q <= bit_abort_i || (bit_valid_i ? full : fresh_q);
      valid_q <= bit_valid_i && full;
      start_q <= bit_start_i;
      done_q  <= bit_done_i;
      abort_q <= bit_abort_i;
    end
  end

  assign word_valid_o  = valid_q;
  assign word_data_o   = word_q;
  assign word_last_o   = last_q;
  assign frame_start_o = start_q;
  assign frame_done_o  = done_q;
  assign frame_abort_o = abort_q;

  `SLOG_ASSERT(SlogPackerAbortAlone, !(bit_abort_i && bit_valid_i))
endmodule : slog_packer
