// SPDX-License-Identifier: Apache-2.0
// The best of Lanes offsets and of those before them, for every pixel: first of equals, neighbours, runner-up.
//
//   take   = score < best
//   best   = take ? score : best;                         index = take ? base + k : index
//   lower  = take ? last : lower;                         upper = take ? Absent : fresh ? score : upper
//   rest   = take ? earlier : fresh ? rest : min(rest, score)
//   next:    earlier = best, last = score, fresh = take   (earlier: the best of all but the offset just before)
//
// A lane is two clocks behind the one before it: in the first it compares, in the second it chooses.
//
// Stage  registers                      valid at lane k, after the clock of winner_i and of lane 0's score
//   1    take_q less_q score_q held_q   2k + 1
//   2    winner_q                       2k + 2
// Latency    : 2 * Lanes clocks from winner_i to winner_o. Lane k's score is taken 2k clocks after winner_i.
// Throughput : one pixel per clock.
// Formats    : sums of mismatches; Absent is above all of them. base_i is the number of lane 0's offset, constant.
// Ties       : of equal sums the offset with the smaller number is the best.
`include "slog_assert.svh"
module slog_dense_winner
  import slog_dense_pkg::*;
  import slog_compare_pkg::*;
#(
    parameter int unsigned Lanes = 8
) (
    input  logic                    clk_i,
    input  logic    [IndexBits-1:0] base_i,
    input  winner_t                 winner_i,
    input  sum_t    [    Lanes-1:0] score_i,
    output winner_t                 winner_o
);
  logic [Lanes-1:0] take_q, less_q;
  sum_t [Lanes-1:0] score_q;
  winner_t held_q[Lanes], winner_q[Lanes];

  // What lane k hands on, from what came to it.
  function automatic winner_t chosen(winner_t held, sum_t own, logic take, logic less, logic [IndexBits-1:0] index);
    winner_t next;
    next.fresh   = take;
    next.index   = take ? index : held.index;
    next.best    = take ? own : held.best;
    next.lower   = take ? held.last : held.lower;
    next.upper   = take ? Absent : held.fresh ? own : held.upper;
    next.rest    = take ? held.earlier : less ? own : held.rest;
    next.earlier = held.best;
    next.last    = own;
    return next;
  endfunction

  always_ff @(posedge clk_i) begin
    static winner_t coming[Lanes];
    coming[0] = winner_i;
    for (int unsigned k = 1; k < Lanes; k++) coming[k] = winner_q[k-1];
    for (int unsigned k = 0; k < Lanes; k++) begin
      take_q[k]   <= is_above(32'(coming[k].best), 32'(score_i[k]));
      less_q[k]   <= is_above(32'(coming[k].rest), 32'(score_i[k])) && !coming[k].fresh;
      score_q[k]  <= score_i[k];
      held_q[k]   <= coming[k];
      winner_q[k] <= chosen(held_q[k], score_q[k], take_q[k], less_q[k], base_i + IndexBits'(k));
    end
  end
  assign winner_o = winner_q[Lanes-1];

  `SLOG_ASSERT_INIT(SlogDenseWinnerLanes, Lanes >= 2 && Lanes <= 2 ** IndexBits)
  // A take is of the smallest so far; what is kept is no larger than what is refused.
  `SLOG_ASSERT_NO_RESET(SlogDenseWinnerBest, !take_q[0] || score_q[0] < held_q[0].best)
endmodule : slog_dense_winner
