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

  `SLOG_ASSERT_NO_RESET(SlogDenseWideWinnerPairs, pair_q[0].offset < 2'd2 && pair_q[1].offset >= 2'd2)
endmodule : slog_dense_wide_winner
