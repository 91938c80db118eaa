// SPDX-License-Identifier: Apache-2.0
// Lanes offsets of the dense engine: their sums, the memory of the row above, and both planes' winners.
//
// Stage  registers                      valid after the clock of left_i and right_i
//   1    left_o right_o                 2 * Lanes, 3 * Lanes (slog_dense_lanes)
//   2    slog_dense_memory              3: the sums of the row above at lane 0, which makes the new ones of them at 4
//   3    slog_dense_winner: winner_o    2 * Lanes + 5; winner_i is taken 5 clocks after left_i
//   4    slog_dense_back: back_o        3 * Lanes + 5; back_i is taken 5 clocks after right_i
// Latency    : winner_i to winner_o 2 * Lanes clocks, back_i to back_o 3 * Lanes: groups in a row fit together.
// Throughput : one pixel per clock.
// Rules      : a row is 2 * Lanes pixels or more, without a pause; more than 2 * Lanes clocks lie between rows. first: all
//              pixels of a pass' first row.
// Reset      : rst_i is held for 1 clock or more; clear_i as in slog_dense_lanes.
`include "slog_assert.svh"
module slog_dense_group
  import slog_dense_pkg::*;
#(
    parameter int unsigned Lanes     = 8,
    parameter int unsigned MaxWindow = 32,
    parameter int unsigned MaxWidth  = 640
) (
    input  logic                    clk_i,
    input  logic                    rst_i,
    input  logic                    clear_i,
    input  logic    [IndexBits-1:0] base_i,
    input  logic    [    Lanes-1:0] used_i,
    input  left_t                   left_i,
    input  right_t                  right_i,
    input  logic    [          1:0] left_ok_i,
    input  logic    [          1:0] right_ok_i,
    input  winner_t                 winner_i,
    input  back_t                   back_i,
    output left_t                   left_o,
    output right_t                  right_o,
    output logic    [          1:0] left_ok_o,
    output logic    [          1:0] right_ok_o,
    output winner_t                 winner_o,
    output back_t                   back_o
);
  sum_t [Lanes-1:0] above, sum, score;

  slog_dense_lanes #(
      .Lanes    (Lanes),
      .MaxWindow(MaxWindow)
  ) u_lanes (
      .clk_i,
      .clear_i,
      .left_i,
      .right_i,
      .left_ok_i,
      .right_ok_i,
      .used_i,
      .above_i(above),
      .sum_o  (sum),
      .score_o(score),
      .left_o,
      .right_o,
      .left_ok_o,
      .right_ok_o
  );

  slog_dense_memory #(
      .Width(Lanes * SumBits),
      .Depth(MaxWidth + 2 * Lanes)
  ) u_memory (
      .clk_i,
      .rst_i,
      .run_i  ((left_i.in_row || left_o.in_row) && !clear_i),
      .first_i((left_i.in_row && left_i.first) || (left_o.in_row && left_o.first)),
      .sum_i  (sum),
      .above_o(above)
  );

  slog_dense_winner #(
      .Lanes(Lanes)
  ) u_winner (
      .clk_i,
      .base_i,
      .winner_i,
      .score_i(score),
      .winner_o
  );

  slog_dense_back #(
      .Lanes(Lanes)
  ) u_back (
      .clk_i,
      .base_i,
      .back_i,
      .score_i(score),
      .back_o
  );
endmodule : slog_dense_group
