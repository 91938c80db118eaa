// Packs the sign bits of each row into words for the bit-plane store.
//
// Bit b of a row's word w is pixel w * GroupBits + b; a row's last word is filled up with zeros. word_data_o and
// word_last_o count only with word_valid_o.
//
// Stages     : 1 as it comes    2 pixel    3, 4 slog_packer_slice: the word so far
// Latency    : 4 clocks from a word's last pixel to word_valid_o; frame_start_o, _done_o, _abort_o follow 4 clocks behind
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
  localparam int unsigned SliceBits = (GroupBits < 16) ? GroupBits : 16;

  logic                 valid_q, dark_q, last_q;
  logic                 blank_q2;                // the pixel is 0 or missing
  logic [GroupBits-1:0] place_q;                 // one-hot: where the pixel goes; not used for a word's first
  logic                 fresh_q;                 // the pixel is a word's first
  logic                 anew_q;                  // the next one is, whatever came
  logic                 valid_q2, valid_q3, valid_q4, last_q2, last_q3, last_q4;
  logic [3:0]           start_q, done_q, abort_q;
  logic                 full;

  assign full = last_q2 || (place_q[GroupBits-1] && !fresh_q);

  always_ff @(posedge clk_i) begin
    dark_q   <= !bit_i;
    blank_q2 <= !valid_q || dark_q;
    last_q   <= bit_last_i;
    last_q2  <= last_q;
    last_q3  <= last_q2;
    last_q4  <= last_q3;
    fresh_q  <= anew_q || (valid_q2 ? full : fresh_q);
    if (fresh_q) place_q <= GroupBits'(2);
    else if (valid_q2) place_q <= place_q << 1;
    if (rst_i) begin
      anew_q   <= 1'b1;
      valid_q  <= 1'b0;
      valid_q2 <= 1'b0;
      valid_q3 <= 1'b0;
      valid_q4 <= 1'b0;
      start_q  <= '0;
      done_q   <= '0;
      abort_q  <= '0;
    end else begin
      anew_q   <= abort_q[0];
      valid_q  <= bit_valid_i;
      valid_q2 <= valid_q;
      valid_q3 <= valid_q2 && full;
      valid_q4 <= valid_q3;
      start_q  <= {start_q[2:0], bit_start_i};
      done_q   <= {done_q[2:0], bit_done_i};
      abort_q  <= {abort_q[2:0], bit_abort_i};
    end
  end

  for (genvar s = 0; s < GroupBits / SliceBits; s++) begin : g_slice
    slog_packer_slice #(
        .Bits (SliceBits),
        .First(s == 0)
    ) u_slice (
        .clk_i,
        .blank_i(blank_q2),
        .fresh_i(fresh_q),
        .place_i(place_q[SliceBits*s+:SliceBits]),
        .word_o (word_data_o[SliceBits*s+:SliceBits])
    );
  end

  assign word_valid_o  = valid_q4;
  assign word_last_o   = last_q4;
  assign frame_start_o = start_q[3];
  assign frame_done_o  = done_q[3];
  assign frame_abort_o = abort_q[3];

  `SLOG_ASSERT_INIT(SlogPackerSlices, GroupBits % SliceBits == 0)
  `SLOG_ASSERT(SlogPackerAbortAlone, !(bit_abort_i && bit_valid_i))
endmodule : slog_packer
