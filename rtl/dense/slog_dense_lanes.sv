// SPDX-License-Identifier: Apache-2.0
// Mismatches of a window around every pixel, for Lanes offsets side by side, as running sums.
//
//   a(x, y)    = L(x, y) ^ R(x - d, y)                                      d is the lane's offset
//   e(x, y)    = a(x, y) - a(x, y-W) - a(x-W, y) + a(x-W, y-W)
//   delta(x)  += e(x, y);  sum(x, y) = sum(x, y-1) + delta(x)               mismatches of the window that ends at (x, y)
//
// The planes move along the lanes: the left one two clocks a lane, the right one three, so lane k compares a left pixel
// with the right pixel k places to its left, and every wire goes from one lane to the next. What one row leaves in delta
// has left it a window's width later, because the bits of W columns ago are those that came in W clocks before.
//
// Stage  registers          valid at lane k, after the clock of left_i and right_i at lane 0
//   1    left_q right_q x_q 2k + 1 (the last of left's two hops and of right's three is at 2k + 2, 3k + 3)
//   2    e_q                2k + 2
//   3    delta_q            2k + 3
//   4    sum_o              2k + 4: above_i is the same column's sum in the row above, taken at 2k + 3
//   5    score_o            2k + 5: the sum where the offset counts at the pixel and the lane is used, else Absent
// Latency    : left_i to left_o 2 * Lanes clocks, right_i to right_o 3 * Lanes; likewise left_ok_i and right_ok_i, which
//              follow left_i and right_i by four clocks.
// Throughput : one pixel per clock.
// Formats    : e is -2..2, delta -W..W, a sum 0..W*W where the window lies in both planes, else undefined.
// Rules      : clear_i is held before a pass until the streams have been 0 for 3 * Lanes + W + 3 clocks; then delta is
//              what came in since. left_ok_i: the left window lies in its plane, bit 0 in even rows and bit 1 in
//              odd ones; right_ok_i likewise. An offset counts where both are of one row: the rows may overlap in time.
`include "slog_assert.svh"
module slog_dense_lanes
  import slog_dense_pkg::*;
#(
    parameter int unsigned Lanes     = 8,
    parameter int unsigned MaxWindow = 32
) (
    input  logic                         clk_i,
    input  logic                         clear_i,
    input  left_t                        left_i,
    input  right_t                       right_i,
    input  logic   [      1:0]           left_ok_i,
    input  logic   [      1:0]           right_ok_i,
    input  logic   [Lanes-1:0]           used_i,
    input  sum_t   [Lanes-1:0]           above_i,
    output sum_t   [Lanes-1:0]           sum_o,
    output sum_t   [Lanes-1:0]           score_o,
    output left_t                        left_o,
    output right_t                       right_o,
    output logic   [      1:0]           left_ok_o,
    output logic   [      1:0]           right_ok_o
);
  localparam int unsigned DeltaBits = $clog2(MaxWindow + 1) + 1;
  typedef logic signed [DeltaBits-1:0] delta_t;

  left_t left_q[Lanes], left_q2[Lanes];
  right_t right_q[Lanes], right_q2[Lanes], right_q3[Lanes];
  logic [Lanes-1:0][1:0] left_ok_q, left_ok_q2, right_ok_q, right_ok_q2, right_ok_q3;
  bits_t [Lanes-1:0] x_q;
  logic signed [Lanes-1:0][2:0] e_q;
  delta_t [Lanes-1:0] delta_q;
  sum_t [Lanes-1:0] sum_q, score_q;

  always_ff @(posedge clk_i) begin
    static left_t left[Lanes];
    static right_t right[Lanes];
    static logic [Lanes-1:0][1:0] left_ok;
    static logic [Lanes-1:0][1:0] right_ok;
    left[0]  = left_i;
    right[0] = right_i;
    for (int unsigned k = 1; k < Lanes; k++) begin
      left[k]  = left_q2[k-1];
      right[k] = right_q3[k-1];
    end
    left_ok  = {left_ok_q2[Lanes-2:0], left_ok_i};
    right_ok = {right_ok_q3[Lanes-2:0], right_ok_i};
    left_q      <= left;
    left_q2     <= left_q;
    right_q     <= right;
    right_q2    <= right_q;
    right_q3    <= right_q2;
    left_ok_q   <= left_ok;
    left_ok_q2  <= left_ok_q;
    right_ok_q  <= right_ok;
    right_ok_q2 <= right_ok_q;
    right_ok_q3 <= right_ok_q2;
    for (int unsigned k = 0; k < Lanes; k++) begin
      x_q[k]     <= left[k].bits ^ right[k].bits;
      e_q[k]     <= 3'(x_q[k].incoming) + 3'(x_q[k].leaving_ago) - 3'(x_q[k].leaving) - 3'(x_q[k].incoming_ago);
      delta_q[k] <= clear_i ? '0 : delta_q[k] + delta_t'(signed'(e_q[k]));
      sum_q[k]   <= above_i[k] + sum_t'(signed'(delta_q[k]));
      score_q[k] <= (left_ok[k] & right_ok[k]) != '0 && used_i[k] ? sum_q[k] : Absent;
    end
  end

  assign sum_o      = sum_q;
  assign score_o    = score_q;
  assign left_o     = left_q2[Lanes-1];
  assign right_o    = right_q3[Lanes-1];
  assign left_ok_o  = left_ok_q2[Lanes-1];
  assign right_ok_o = right_ok_q3[Lanes-1];

  `SLOG_ASSERT_INIT(SlogDenseLanesSizes, Lanes >= 2 && MaxWindow >= 2 && MaxWindow ** 2 < 2 ** SumBits - 1)
endmodule : slog_dense_lanes
