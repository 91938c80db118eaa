// SPDX-License-Identifier: Apache-2.0
// Packs the sign bits of each row into words for the bit-plane store.
//
// Bit b of a row's word w is pixel w * GroupBits + b; a row's last word is filled up with zeros. word_data_o and
// word_last_o are valid only with word_valid_o.
//
// Stages     : 1 input    2 pixel and its place    3 delayed for the slices    4 to 6 slog_packer_slice: the word so far
// Latency    : 6 clocks from a word's last pixel to word_valid_o; frame_start_o, _done_o, _abort_o follow 6 clocks after
//              their inputs: a frame's first word follows GroupBits - 1 clocks after frame_start_o.
// Throughput : one pixel per clock; words cannot be stalled.
// Reset      : rst_i is held for 1 clock or more.
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
  localparam int unsigned Slices = GroupBits / SliceBits;
  localparam int unsigned PlaceW = $clog2(GroupBits);

  logic              valid_q, dark_q;
  // The pixel and its place in the word; without a pixel, the place of the next one.
  logic              valid_q2;
  logic              blank_q2;        // the pixel is 0, or there is none
  logic [PlaceW-1:0] place_q;
  logic              fresh_q, end_q;  // place_q is the word's first, last place
  logic [Slices-1:0] begin_q;         // [s]: place_q is the first place of slice s
  logic              anew_q;          // after an abort or reset: the next pixel is a word's first
  logic [5:0]        last_q;
  logic [5:2]        full_q;          // [k]: in stage k + 1, a word is complete
  logic [5:0]        start_q, done_q, abort_q;
  // Stage 3, between the place counter and the slices, which lie far apart.
  logic              valid_q3, blank_q3, fresh_q2;
  logic [Slices-1:0] begin_q2;
  logic              full, restart;

  assign full    = valid_q2 && (last_q[1] || end_q);
  assign restart = anew_q || full;

  always_ff @(posedge clk_i) begin
    dark_q   <= !bit_i;
    blank_q2 <= !valid_q || dark_q;
    last_q   <= {last_q[4:0], bit_last_i};
    valid_q3 <= valid_q2;
    blank_q3 <= blank_q2;
    fresh_q2 <= fresh_q;
    begin_q2 <= begin_q;
    if (restart) place_q <= '0;
    else if (valid_q2) place_q <= place_q + 1'b1;
    fresh_q <= restart || (!valid_q2 && fresh_q);
    end_q   <= !restart && (valid_q2 ? place_q == PlaceW'(GroupBits - 2) : end_q);
    for (int unsigned s = 0; s < Slices; s++) begin
      if (s == 0) begin_q[s] <= restart || (!valid_q2 && begin_q[s]);
      else begin_q[s] <= !restart && (valid_q2 ? place_q == PlaceW'(SliceBits * s - 1) : begin_q[s]);
    end
    if (rst_i) begin
      anew_q   <= 1'b1;
      valid_q  <= 1'b0;
      valid_q2 <= 1'b0;
      full_q   <= '0;
      start_q  <= '0;
      done_q   <= '0;
      abort_q  <= '0;
    end else begin
      anew_q   <= abort_q[0];
      valid_q  <= bit_valid_i;
      valid_q2 <= valid_q;
      full_q   <= {full_q[4:2], full};
      start_q  <= {start_q[4:0], bit_start_i};
      done_q   <= {done_q[4:0], bit_done_i};
      abort_q  <= {abort_q[4:0], bit_abort_i};
    end
  end

  for (genvar s = 0; s < Slices; s++) begin : g_slice
    slog_packer_slice #(
        .Bits(SliceBits)
    ) u_slice (
        .clk_i,
        .valid_i(valid_q3),
        .blank_i(blank_q3),
        .fresh_i(fresh_q2),
        .begin_i(begin_q2[s]),
        .word_o (word_data_o[SliceBits*s+:SliceBits])
    );
  end

  assign word_valid_o  = full_q[5];
  assign word_last_o   = last_q[5];
  assign frame_start_o = start_q[5];
  assign frame_done_o  = done_q[5];
  assign frame_abort_o = abort_q[5];

  `SLOG_ASSERT_INIT(SlogPackerSlices, GroupBits % SliceBits == 0 && SliceBits > 1)
  `SLOG_ASSERT(SlogPackerAbortAlone, !(bit_abort_i && bit_valid_i))
endmodule : slog_packer
