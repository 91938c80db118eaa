// SPDX-License-Identifier: Apache-2.0
// Four offsets of the wide dense engine: their sums at four columns per clock, the memory of the row above, winners.
//
// Offset s of the group sets column 4t + j of the left plane against column j - s of the right word that comes with it, in
// which the word before has the columns -4 to -1. From group to group the left words move one clock, the right ones two:
// the next group meets the right plane four columns further to the left.
//
// Stage  registers                     valid after the clock of left_i and right_i
//   1    left_o left_ok_o, right_q     1: right_q is the word before, where left_i is taken
//   2    right_o right_ok_o            2
//   3    slog_dense_memory             5: the sums of the row above, of which slog_dense_wide_lane makes those at 6
//   4    slog_dense_wide_lane: score   7: left_ok_i and right_ok_i follow left_i and right_i by 6 clocks
//   5    slog_dense_wide_winner        10: winner_o; winner_i is taken at 9
// Latency    : left_i to left_o and winner_i to winner_o 1 clock, right_i to right_o 2: groups in a row fit together.
// Throughput : four pixels per clock.
// Rules      : a left row is four words or more; a clock or more lies between left rows. A right row may follow the one
//              before at once. No row has a pause. first: all words of a pass' first row, and of no other. slog_dense_wide
//              asserts this for all groups. clear_i as in slog_dense_wide_lane; what comes in with it is not in a row.
// Reset      : rst_i is held for 1 clock or more; clear_i is high in the clock after it.
`include "slog_assert.svh"
module slog_dense_wide_group
  import slog_dense_wide_pkg::*;
#(
    parameter int unsigned MaxWidth = 640
) (
    input  logic                         clk_i,
    input  logic                         rst_i,
    input  logic                         clear_i,
    input  logic         [GroupBits-1:0] base_i,
    input  logic                         in_row_i,
    input  logic                         first_i,
    input  wide_bits_t                   left_i,
    input  wide_bits_t                   right_i,
    input  wide_ok_t                     left_ok_i,
    input  wide_ok_t                     right_ok_i,
    input  wide_winner_t [  Columns-1:0] winner_i,
    output logic                         in_row_o,
    output logic                         first_o,
    output wide_bits_t                   left_o,
    output wide_bits_t                   right_o,
    output wide_ok_t                     left_ok_o,
    output wide_ok_t                     right_ok_o,
    output wide_winner_t [  Columns-1:0] winner_o
);
  logic in_row_q, in_row_q2, first_q, first_q2;
  wide_bits_t left_q, right_q, right_q2;
  wide_ok_t left_ok_q, right_ok_q, right_ok_q2;
  logic [Columns-1:0] right_ok, right_ok_before;  // of the row that the left word is of
  logic [Columns-1:0][Columns-1:0] ok;            // of each offset and column
  wide_sums_t [Columns-1:0] above, sums;
  wide_score_t [Columns-1:0][Columns-1:0] score;  // of each offset and column

  always_ff @(posedge clk_i) begin
    in_row_q    <= in_row_i && !clear_i;
    in_row_q2   <= in_row_q && !clear_i;
    first_q     <= first_i;
    first_q2    <= first_q;
    left_q      <= left_i;
    right_q     <= right_i;
    right_q2    <= right_q;
    left_ok_q   <= left_ok_i;
    right_ok_q  <= right_ok_i;
    right_ok_q2 <= right_ok_q;
  end

  // Columns -s to 3 - s, of those of the word that comes and of the last one.
  function automatic logic [Columns-1:0] shifted(logic [Columns-1:0] word, logic [Columns-1:0] last, int unsigned s);
    return Columns'({word, last} >> (Columns - s));
  endfunction

  assign right_ok        = right_ok_i.columns & {Columns{right_ok_i.odd == left_ok_i.odd}};
  assign right_ok_before = right_ok_q.columns & {Columns{right_ok_q.odd == left_ok_i.odd}};

  for (genvar s = 0; s < Columns; s++) begin : g_lane
    assign ok[s] = left_ok_i.columns & shifted(right_ok, right_ok_before, s);
    slog_dense_wide_lane u_lane (
        .clk_i,
        .clear_i,
        .left_i,
        .right_i('{incoming: shifted(right_i.incoming, right_q.incoming, s),
                   leaving: shifted(right_i.leaving, right_q.leaving, s),
                   incoming_ago: shifted(right_i.incoming_ago, right_q.incoming_ago, s),
                   leaving_ago: shifted(right_i.leaving_ago, right_q.leaving_ago, s)}),
        .ok_i   (ok[s]),
        .above_i(above[s]),
        .sums_o (sums[s]),
        .score_o(score[s])
    );
  end

  slog_dense_memory #(
      .Width(Columns * $bits(wide_sums_t)),
      .Depth(MaxWidth / Columns)
  ) u_memory (
      .clk_i,
      .rst_i  (rst_i || clear_i),
      .run_i  (in_row_q2),
      .first_i(first_q2),
      .sum_i  (sums),
      .above_o(above)
  );

  for (genvar j = 0; j < Columns; j++) begin : g_column
    slog_dense_wide_winner u_winner (
        .clk_i,
        .base_i,
        .score_i ({score[3][j], score[2][j], score[1][j], score[0][j]}),
        .winner_i(winner_i[j]),
        .winner_o(winner_o[j])
    );
  end

  assign in_row_o   = in_row_q;
  assign first_o    = first_q;
  assign left_o     = left_q;
  assign right_o    = right_q2;
  assign left_ok_o  = left_ok_q;
  assign right_ok_o = right_ok_q2;

  `SLOG_ASSERT_INIT(SlogDenseWideGroupSizes, MaxWidth % Columns == 0 && MaxWidth >= 4 * Columns)
  `SLOG_PAST(past_rst, rst_i)
  `SLOG_ASSERT(SlogDenseWideGroupReset, !past_rst || clear_i)
`ifndef SYNTHESIS
  localparam int unsigned ScoreLag = 7;
  logic [ScoreLag-1:0] run_q;  // [n]: in a row n + 1 clocks ago, and no clear_i since
  always_ff @(posedge clk_i) run_q <= rst_i || clear_i ? '0 : {run_q[ScoreLag-2:0], in_row_i};

  function automatic logic is_within(logic signed [7:0] value, int most);
    return 32'(value) >= -most && 32'(value) <= most;
  endfunction
`endif
  // Sums of windows that lie in both planes, of 32x32 pixels at most.
  for (genvar s = 0; s < Columns; s++) begin : g_sums
    `SLOG_ASSERT(SlogDenseWideGroupLess, !run_q[ScoreLag-2] ||
                 ((!ok[s][0] || is_within(sums[s].less0, 96)) && (!ok[s][1] || is_within(sums[s].less1, 64)) &&
                  (!ok[s][2] || is_within(8'(sums[s].less2), 32))))
    for (genvar j = 0; j < Columns; j++) begin : g_sum
      `SLOG_ASSERT(SlogDenseWideGroupSum, !run_q[ScoreLag-1] || score[s][j].absent || 32'(score[s][j].sum) <= 1024)
    end
  end
endmodule : slog_dense_wide_group
