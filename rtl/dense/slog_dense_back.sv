// SPDX-License-Identifier: Apache-2.0
// The best offset of every pixel of the right plane, among Lanes offsets and those before them.
//
//   take = score < best;  best = take ? score : best;  index = take ? base + k : index
//
// A right pixel moves three clocks a lane, and meets in lane k the score of the left pixel k places to its right.
//
// Stage  registers                valid at lane k, after the clock of back_i and of lane 0's score
//   1    take_q score_q held_q    3k + 1
//   2    chosen_q                 3k + 2
//   3    back_q                   3k + 3
// Latency    : 3 * Lanes clocks from back_i to back_o. Lane k's score is taken 3k clocks after back_i.
// Throughput : one pixel per clock.
// Formats    : sums of mismatches; Absent is above all of them. base_i is the number of lane 0's offset, constant.
// Ties       : of equal sums the offset with the smaller number is the best.
`include "slog_assert.svh"
module slog_dense_back
  import slog_dense_pkg::*;
  import slog_compare_pkg::*;
#(
    parameter int unsigned Lanes = 8
) (
    input  logic                  clk_i,
    input  logic  [IndexBits-1:0] base_i,
    input  back_t                 back_i,
    input  sum_t  [    Lanes-1:0] score_i,
    output back_t                 back_o
);
  logic [Lanes-1:0] take_q;
  sum_t [Lanes-1:0] score_q;
  back_t held_q[Lanes], chosen_q[Lanes], back_q[Lanes];

  always_ff @(posedge clk_i) begin
    static back_t coming[Lanes];
    coming[0] = back_i;
    for (int unsigned k = 1; k < Lanes; k++) coming[k] = back_q[k-1];
    for (int unsigned k = 0; k < Lanes; k++) begin
      take_q[k]         <= is_above(32'(coming[k].best), 32'(score_i[k]));
      score_q[k]        <= score_i[k];
      held_q[k]         <= coming[k];
      chosen_q[k].best  <= take_q[k] ? score_q[k] : held_q[k].best;
      chosen_q[k].index <= take_q[k] ? base_i + IndexBits'(k) : held_q[k].index;
    end
    back_q <= chosen_q;
  end
  assign back_o = back_q[Lanes-1];

  `SLOG_ASSERT_INIT(SlogDenseBackLanes, Lanes >= 2 && Lanes <= 2 ** IndexBits)
  `SLOG_ASSERT_NO_RESET(SlogDenseBackBest, !take_q[0] || score_q[0] < held_q[0].best)
endmodule : slog_dense_back
