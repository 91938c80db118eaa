// SPDX-License-Identifier: Apache-2.0
// slog_peak_rows against a plain count: a job's rows are 0 .. offsets_y - 1, each with the job's context; a refused job has one.
module slog_rules_peak_rows
  import slog_pkg::*, slog_peak_pkg::*;
(
    input logic       clk_i,
    input logic       rst_i,
    input logic       ctx_valid_i,
    input logic       ctx_ready_o,
    input context_t   ctx_i,
    input logic       row_coming_o,
    input logic       row_taken_i,
    input row_t       row_o,
    input logic       refused_o,
    input scoring_t   scoring_o,
    input logic [9:0] left_q,
    input logic       some_q,
    input logic       step_q
);
  context_t job_q;
  logic has_q, there_q;   // a context is in work; a row can be taken
  logic [9:0] y_q;
  logic refused, last;
  assign refused = job_q.status != StatusOk;
  assign last    = refused || y_q == job_q.offsets_y - 10'd1;
  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      has_q   <= 1'b0;
      there_q <= 1'b0;
    end else begin
      there_q <= row_coming_o && !row_taken_i;
      if (ctx_valid_i && ctx_ready_o) begin
        has_q <= 1'b1;
        job_q <= ctx_i;
        y_q   <= '0;
      end else if (row_taken_i) begin
        has_q <= !last;
        y_q   <= y_q + 1'b1;
      end
    end
    if (!rst_i) begin
      AssumeSome : assume (!ctx_valid_i || ctx_i.status != StatusOk || (ctx_i.offsets_x != '0 && ctx_i.offsets_y != '0));
      AssumeThere : assume (!row_taken_i || there_q);
      RulesPeakRowsOne : assert (!(ctx_valid_i && ctx_ready_o) || !has_q);
      RulesPeakRowsHas : assert (some_q == has_q && (!there_q || (has_q && !step_q)));
      RulesPeakRowsLeft : assert (!has_q || (!refused && y_q >= job_q.offsets_y) || refused || step_q
                                  || left_q == job_q.offsets_y - 10'd1 - y_q);
      RulesPeakRowsStep : assert (!step_q || (has_q && !refused && y_q != '0 && y_q < job_q.offsets_y
                                              && left_q == job_q.offsets_y - y_q && row_o.y == y_q - 10'd1 && !row_o.last));
      RulesPeakRowsInside : assert (!has_q || refused || y_q < job_q.offsets_y);
      RulesPeakRowsData : assert (!has_q || (row_o.tag == job_q.tag && row_o.status == job_q.status && refused_o == refused
          && row_o.last_x == job_q.offsets_x - 10'd1 && scoring_o == scoring_t'{surface: job_q.surface,
             one: job_q.offsets_x == 10'd1, two: job_q.offsets_x == 10'd2, area: job_q.area}));
      RulesPeakRowsPlace : assert (!has_q || step_q || (row_o.y == y_q && row_o.first == (y_q == '0) && row_o.last == last));
      CoverThird : cover (row_taken_i && row_o.y == 10'd2 && row_o.last);
      CoverRefused : cover (row_taken_i && refused_o);
    end
  end
endmodule : slog_rules_peak_rows

bind slog_peak_rows slog_rules_peak_rows u_rules (.*);
