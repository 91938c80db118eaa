// SPDX-License-Identifier: Apache-2.0
// Collects a job's neighbours and runner-up from the scans of its rows by slog_peak_scan.
//
//   runner-up after a row = max(other, fresh ? far : runner-up before)
//
// fresh: the row holds the best so far (slog_peak_best, in outcome_t). far: the greatest score outside the best's
// neighbourhood (slog_peak_scan). other: the candidate that needs no scan (slog_peak_best, in outcome_t).
//
// Neighbours are output one clock after the job's last column; the verdict three clocks after the last far_valid_i:
//   0  far_valid_i      1  compare      2  select      3  verdict_valid_o
// Throughput : a row in two clocks, columns one per clock. Never stalls: slog_peak reserves room for both outputs.
// Formats    : absent scores are output as NoScore.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_peak_collect
  import slog_pkg::*;
  import slog_peak_pkg::*;
  import slog_compare_pkg::*;
(
    input  logic                   clk_i,
    input  logic                   rst_i,
    // Columns of slog_peak_scan.
    input  logic                   near_first_i,
    input  logic                   near_end_i,
    input  logic                   near_west_i,
    input  logic                   near_centre_i,
    input  logic                   near_east_i,
    input  maybe_t                 near_above_i,
    input  maybe_t                 near_middle_i,
    input  maybe_t                 near_below_i,
    // Rows: outcome_i belongs to the row that far_valid_i completes.
    input  logic                   far_valid_i,
    input  maybe_t                 far_i,
    input  outcome_t               outcome_i,
    output logic                   around_valid_o,
    output logic [7:0][ScoreW-1:0] around_o,      // NW N NE W E SW S SE, [0] is NW
    output logic                   verdict_valid_o,
    output verdict_t               verdict_o
);
  maybe_t around_q[8];
  logic around_end_q;

  // The first column of a scan marks every neighbour as absent; the neighbour's own column then sets it.
  always_ff @(posedge clk_i) begin
    if (near_west_i || near_first_i) begin
      around_q[0] <= near_west_i ? near_above_i : '0;
      around_q[3] <= near_west_i ? near_middle_i : '0;
      around_q[5] <= near_west_i ? near_below_i : '0;
    end
    if (near_centre_i || near_first_i) begin
      around_q[1] <= near_centre_i ? near_above_i : '0;
      around_q[6] <= near_centre_i ? near_below_i : '0;
    end
    if (near_east_i || near_first_i) begin
      around_q[2] <= near_east_i ? near_above_i : '0;
      around_q[4] <= near_east_i ? near_middle_i : '0;
      around_q[7] <= near_east_i ? near_below_i : '0;
    end
  end

  always_comb begin
    for (int i = 0; i < 8; i++) around_o[i] = or_no_score(around_q[i]);
  end

  logic s1_valid_q, s2_valid_q, s3_valid_q;
  maybe_t s1_far_q, s2_far_q, runner_up_q;
  outcome_t s1_outcome_q, s2_outcome_q;
  logic s2_above_far_q, s2_above_held_q;
  verdict_t s3_verdict_q;  // all but the runner-up

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      around_end_q <= 1'b0;
      s1_valid_q   <= 1'b0;
      s2_valid_q   <= 1'b0;
      s3_valid_q   <= 1'b0;
    end else begin
      around_end_q <= near_end_i;
      s1_valid_q   <= far_valid_i;
      s2_valid_q   <= s1_valid_q;
      s3_valid_q   <= s2_valid_q && s2_outcome_q.last;
    end
  end

  always_ff @(posedge clk_i) begin
    s1_outcome_q <= outcome_i;
    s1_far_q     <= far_i;
    if (s1_valid_q) begin
      s2_outcome_q    <= s1_outcome_q;
      s2_far_q        <= s1_far_q;
      s2_above_far_q  <= is_above(32'(s1_outcome_q.other), 32'(s1_far_q));
      s2_above_held_q <= is_above(32'(s1_outcome_q.other), 32'(runner_up_q));
    end
    if (s2_valid_q) begin
      s3_verdict_q <= '{tag: s2_outcome_q.tag, status: s2_outcome_q.status, best_x: s2_outcome_q.best_x,
                        best_y: s2_outcome_q.best_y, score: or_no_score(s2_outcome_q.score), runner_up: '0};
      if (s2_outcome_q.fresh) runner_up_q <= s2_above_far_q ? s2_outcome_q.other : s2_far_q;
      else if (s2_above_held_q) runner_up_q <= s2_outcome_q.other;
    end
  end

  assign around_valid_o  = around_end_q;
  assign verdict_valid_o = s3_valid_q;
  always_comb begin
    verdict_o           = s3_verdict_q;
    verdict_o.runner_up = or_no_score(runner_up_q);
  end

  `SLOG_ASSERT(SlogPeakCollectSpacing, !(far_valid_i && s1_valid_q))
endmodule : slog_peak_collect
