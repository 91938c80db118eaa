// SPDX-License-Identifier: Apache-2.0
// The best of a group's four offsets and of those before it, for one of the four columns: first of equals.
//
//   pair[p] = score[2p+1] < score[2p] ? score[2p+1] : score[2p]           p = 0, 1; likewise the two pairs' best
//   winner  = best of the group < winner of the groups before ? best of the group : winner before
//
// Stage  registers   valid after the clock of score_i
//   1    pair_q      1
//   2    best_q      2: winner_i is taken at 2
//   3    winner_o    3
// Latency    : 1 clock from winner_i to winner_o, 3 from score_i.
// Throughput : one column per clock.
// Formats    : scores are compared as numbers of 12 bits: an absent one is above all sums. base_i is the group's number,
//              constant: its offsets are base_i * 4 to base_i * 4 + 3.
// Ties       : of equal sums the offset with the smaller number is the best.
`include "slog_assert.svh"
module slog_dense_wide_winner
  import slog_dense_wide_pkg::*;
(
    input  logic                         clk_i,
    input  logic         [GroupBits-1:0] base_i,
    input  wide_score_t  [  Columns-1:0] score_i,
    input  wide_winner_t                 winner_i,
    output wide_winner_t                 winner_o
);
  import slog_compare_pkg::*;
  localparam int unsigned Pairs = Columns / 2;

  typedef struct packed {
    logic [$clog2(Columns)-1:0] offset;  // within the group
    wide_score_t                score;
  } best_t;

  best_t [Pairs-1:0] pair_q;
  best_t best_q;
  wide_winner_t winner_q;

  function automatic logic is_less(wide_score_t a, wide_score_t b);
    return is_above(32'(b), 32'(a));
  endfunction

  always_ff @(posedge clk_i) begin
    for (int unsigned p = 0; p < Pairs; p++) begin
      pair_q[p] <= is_less(score_i[2*p+1], score_i[2*p]) ? '{offset: 2'(2 * p + 1), score: score_i[2*p+1]}
                                                        : '{offset: 2'(2 * p), score: score_i[2*p]};
    end
    best_q   <= is_less(pair_q[1].score, pair_q[0].score) ? pair_q[1] : pair_q[0];
    winner_q <= is_less(best_q.score, winner_i.score) ? '{index: {base_i, best_q.offset}, score: best_q.score}
                                                      : winner_i;
  end
  assign winner_o = winner_q;

`ifndef SYNTHESIS
  wide_score_t [Columns-1:0] past_score, group_score;  // score_i of the clock before; those that best_q is of
  best_t past_best;
  wide_winner_t past_winner;
  logic [GroupBits-1:0] past_base;
  always_ff @(posedge clk_i) begin
    past_score  <= score_i;
    group_score <= past_score;
    past_best   <= best_q;
    past_winner <= winner_i;
    past_base   <= base_i;
  end
`endif
  for (genvar s = 0; s < Columns; s++) begin : g_score
    `SLOG_ASSERT_NO_RESET(SlogDenseWideWinnerBest, !is_less(group_score[s], best_q.score) &&
                          (!is_above(32'(best_q.offset), s) || is_less(best_q.score, group_score[s])))
  end
  `SLOG_ASSERT_NO_RESET(SlogDenseWideWinnerOwn, best_q.score == group_score[best_q.offset])
  `SLOG_ASSERT_NO_RESET(SlogDenseWideWinnerLeast, !is_less(past_winner.score, winner_q.score) &&
                        !is_less(past_best.score, winner_q.score))
  `SLOG_ASSERT_NO_RESET(SlogDenseWideWinnerOneOf, winner_q == past_winner ||
                        (winner_q == '{index: {past_base, past_best.offset}, score: past_best.score} &&
                         is_less(past_best.score, past_winner.score)))
endmodule : slog_dense_wide_winner
