// SPDX-License-Identifier: Apache-2.0
// Selects a few bits of every unit of the operand rows from the words that the search ring's memories output.
//
//   a = units chunk .. chunk+2 of the row of parity odd_a
//   b = units chunk .. chunk+2 of the row of parity odd_b, or chunk+2 .. chunk+4 if wide
//
// A unit is half a word. The selection is the same for every bit of a unit, so the ring is cut into slices of a few
// bits of every unit, each with its own registers for the selecting bits: no net has to reach all words.
//
// Stage  registers          valid after the clock of odd_a_i .. chunk_i
//   1    odd_*_q .. chunk_q 1; word_i is taken in that clock
//   2    a_q2[4] b_q2[4]    2: words of the row
//   3    a_q3[3] b_q3[4]    3: words in order, from the quad that holds unit chunk on
//   4    a_q4[2] b_q4[2]    4: words from the one that holds the first unit on
//   5    a_o b_o            5: units in order; zero if blank_a_i, blank_b_i or rst_i was high two clocks before
//
// Throughput : one choice per clock.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_ring_slice #(
    parameter  int unsigned UnitBits = 4,
    localparam int unsigned WordBits = 2 * UnitBits
) (
    input  logic                           clk_i,
    input  logic                           rst_i,
    input  logic                           odd_a_i,
    input  logic                           odd_b_i,
    input  logic                           wide_i,
    input  logic [2:0]                     chunk_i,
    input  logic                           blank_a_i,
    input  logic                           blank_b_i,
    input  logic [7:0][WordBits-1:0]       word_i,  // [{row parity, quad parity, word parity}]
    output logic [WordBits+UnitBits-1:0]   a_o,
    output logic [WordBits+UnitBits-1:0]   b_o
);
  logic odd_a_q, odd_b_q, wide_q, wide_q2, wide_q3, chunk_q4, blank_a_q, blank_b_q;
  logic [2:0] chunk_q, chunk_q2;
  logic [1:0] chunk_q3;
  logic [WordBits-1:0] a_q2[4], b_q2[4], a_q3[3], b_q3[4], a_q4[2], b_q4[2];

  always_ff @(posedge clk_i) begin
    odd_a_q  <= odd_a_i;
    odd_b_q  <= odd_b_i;
    wide_q   <= wide_i;
    wide_q2  <= wide_q;
    wide_q3  <= wide_q2;
    chunk_q  <= chunk_i;
    chunk_q2 <= chunk_q;
    chunk_q3 <= chunk_q2[1:0];
    chunk_q4 <= chunk_q3[0];
    blank_a_q <= blank_a_i;
    blank_b_q <= blank_b_i;
    if (rst_i) begin
      blank_a_q <= 1'b1;
      blank_b_q <= 1'b1;
    end

    for (int unsigned m = 0; m < 4; m++) begin
      a_q2[m] <= word_i[{odd_a_q, 2'(m)}];
      b_q2[m] <= word_i[{odd_b_q, 2'(m)}];
    end

    for (int unsigned m = 0; m < 3; m++) a_q3[m] <= a_q2[{1'(m >> 1) ^ chunk_q2[2], 1'(m)}];
    for (int unsigned m = 0; m < 4; m++) b_q3[m] <= b_q2[{1'(m >> 1) ^ chunk_q2[2], 1'(m)}];

    a_q4[0] <= chunk_q3[1] ? a_q3[1] : a_q3[0];
    a_q4[1] <= chunk_q3[1] ? a_q3[2] : a_q3[1];
    if (chunk_q3[1] && wide_q3) begin
      b_q4[0] <= b_q3[2];
      b_q4[1] <= b_q3[3];
    end else if (chunk_q3[1] || wide_q3) begin
      b_q4[0] <= b_q3[1];
      b_q4[1] <= b_q3[2];
    end else begin
      b_q4[0] <= b_q3[0];
      b_q4[1] <= b_q3[1];
    end

    if (blank_a_q) a_o <= '0;
    else if (chunk_q4) a_o <= {a_q4[1], a_q4[0][WordBits-1:UnitBits]};
    else a_o <= {a_q4[1][UnitBits-1:0], a_q4[0]};
    if (blank_b_q) b_o <= '0;
    else if (chunk_q4) b_o <= {b_q4[1], b_q4[0][WordBits-1:UnitBits]};
    else b_o <= {b_q4[1][UnitBits-1:0], b_q4[0]};
  end

  `SLOG_PAST(past_blank, {blank_b_i, blank_a_i})
  `SLOG_PAST(past_blank2, past_blank)
  // In the clock after a reset of one clock, the outputs are those of a state before it.
  `SLOG_PAST(past_rst, rst_i)
  `SLOG_ASSERT(SlogRingSliceBlank, past_rst || ((!past_blank2[0] || a_o == '0) && (!past_blank2[1] || b_o == '0)))
endmodule : slog_ring_slice
