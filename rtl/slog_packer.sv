// Packs the sign bits of each row into words for the bit-plane store.
//
// Bit b of a row's word w is pixel w * GroupBits + b; a row's last word is filled up with zeros.
//
// Latency    : 1 clock from a word's last pixel to word_valid_o; frame_start_o, _done_o, _abort_o follow 1 clock behind
//              the pixel (or gap) they come with: a frame's first word comes GroupBits - 1 clocks after frame_start_o.
// Throughput : one pixel per clock; the sink takes every word.
`include "slog_assert.svh"
module slog_packer #(
    parameter  int unsigned GroupBits = 8,
    localparam int unsigned CountW    = $clog2(GroupBits)
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
  logic [GroupBits-1:0] part_q, word_q, word;
  logic [CountW-1:0]    count_q;
  logic                 valid_q, last_q, start_q, done_q, abort_q;
  logic                 full;

  assign full = bit_last_i || count_q == CountW'(GroupBits - 1);

  always_comb begin
    word          = part_q;
    word[count_q] = bit_i;
  end

  always_ff @(posedge clk_i) begin
    if (bit_valid_i && full) begin
      word_q <= word;
      last_q <= bit_last_i;
    end
    if (rst_i || bit_abort_i) begin
      part_q  <= '0;
      count_q <= '0;
    end else if (bit_valid_i) begin
      part_q  <= full ? '0 : word;
      count_q <= full ? '0 : count_q + 1'b1;
    end
    if (rst_i) begin
      valid_q <= 1'b0;
      start_q <= 1'b0;
      done_q  <= 1'b0;
      abort_q <= 1'b0;
    end else begin
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
