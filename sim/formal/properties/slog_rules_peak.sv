// SPDX-License-Identifier: Apache-2.0
// slog_peak as a whole against the definition of its result, for one job of up to 3 x 3 offsets with any scores 0..3:
// the best, the first in raster order; its neighbours; the runner-up outside its neighbourhood.
//
// A row has MaxOffsets offsets, the job as many rows as the queue of scores holds. Nothing is stalled.
module slog_rules_peak
  import slog_pkg::*;
#(
    parameter int unsigned ScoreBits = 2,
    parameter int unsigned MaxOffsets = 3,
    parameter int unsigned Rows       = 3
) (
    input logic                 clk_i,
    input logic                 rst_i,
    input logic                 ctx_valid_i,
    input logic                 ctx_ready_o,
    input context_t             ctx_i,
    input logic                 row_valid_i,
    input logic                 row_ready_o,
    input logic [9:0]           row_offsets_i,
    input logic                 mismatch_valid_i,
    input logic [ScoreBits-1:0] mismatch_i,
    input logic                 res_valid_o,
    input logic                 res_ready_i,
    input result_t              res_o
);
  logic [8:0][1:0] mismatch;       // [3 * y + x]
  localparam logic [1:0] Across = 2'(MaxOffsets);
  localparam logic [1:0] Down   = 2'(Rows);
  slog_rules_choice #(.Width(18)) u_choice (.clk_i, .choice(mismatch));
  logic began_q, taken_q, seen_q;  // the reset is over; the context, the result was taken
  logic [1:0] granted_q;
  logic [3:0] owed_q, at_x_q, at_y_q;
  logic [6:0] clock_q;
  result_t wanted;
  logic grant;
  assign grant = row_valid_i && row_ready_o;

  function automatic logic [ScoreW-1:0] score(int x, int y);
    if (x < 0 || y < 0 || x >= int'(Across) || y >= int'(Down)) return NoScore;
    return ScoreW'(3 - int'(mismatch[3*y+x]));
  endfunction
  always_comb begin
    int best_x, best_y;
    best_x = 0;
    best_y = 0;
    for (int y = 0; y < 3; y++) for (int x = 0; x < 3; x++) begin
      if (x < int'(Across) && y < int'(Down) && score(x, y) > score(best_x, best_y)) begin
        best_x = x;
        best_y = y;
      end
    end
    wanted           = '0;
    wanted.tag       = 16'd1;
    wanted.best_x    = 10'(best_x);
    wanted.best_y    = 10'(best_y);
    wanted.score     = score(best_x, best_y);
    wanted.neighbour = {score(best_x + 1, best_y + 1), score(best_x, best_y + 1), score(best_x - 1, best_y + 1),
                        score(best_x + 1, best_y), score(best_x - 1, best_y),
                        score(best_x + 1, best_y - 1), score(best_x, best_y - 1), score(best_x - 1, best_y - 1)};
    wanted.runner_up = NoScore;
    for (int y = 0; y < 3; y++) for (int x = 0; x < 3; x++) begin
      if (x < int'(Across) && y < int'(Down) && (x > best_x + 1 || x < best_x - 1 || y > best_y + 1 || y < best_y - 1)
          && (wanted.runner_up == NoScore || score(x, y) > wanted.runner_up)) wanted.runner_up = score(x, y);
    end
  end

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      began_q   <= 1'b1;
      taken_q   <= 1'b0;
      seen_q    <= 1'b0;
      granted_q <= '0;
      owed_q    <= '0;
      at_x_q    <= '0;
      at_y_q    <= '0;
      clock_q   <= '0;
    end else begin
      clock_q <= clock_q + 1'b1;
      if (ctx_valid_i && ctx_ready_o) taken_q <= 1'b1;
      granted_q <= granted_q + 2'(grant);
      owed_q    <= owed_q + (grant ? 4'(Across) : '0) - 4'(mismatch_valid_i);
      if (mismatch_valid_i) begin
        at_x_q <= (at_x_q == 4'(Across) - 1'b1) ? '0 : at_x_q + 1'b1;
        if (at_x_q == 4'(Across) - 1'b1) at_y_q <= at_y_q + 1'b1;
      end
      if (res_valid_o) seen_q <= 1'b1;
    end
    if (!rst_i) begin
      AssumeContext : assume (ctx_valid_i == !taken_q && ctx_i == context_t'{tag: 16'd1, surface: 1'b0, status: StatusOk,
                              offsets_x: 10'(Across), offsets_y: 10'(Down), area: ScoreW'(3)});
      AssumeRow : assume (row_valid_i == (taken_q && granted_q < Down) && row_offsets_i == 10'(Across));
      AssumeScore : assume (mismatch_valid_i == (owed_q != '0) && (!mismatch_valid_i
                            || mismatch_i == ScoreBits'(mismatch[4'd3*at_y_q+at_x_q])));
      AssumeTaken : assume (res_ready_i);
      RulesPeakResult : assert (!res_valid_o || res_o == wanted);
      RulesPeakOnce : assert (!(res_valid_o && seen_q));
      RulesPeakArrives : assert (clock_q < 7'd56 || seen_q);
      CoverRunnerUp : cover (res_valid_o && res_o.runner_up == res_o.score);
    end
  end
endmodule : slog_rules_peak

bind slog_peak slog_rules_peak #(.ScoreBits(ScoreBits), .MaxOffsets(MaxOffsets),
                                         .Rows(ScoreDepth / MaxOffsets)) u_rules (.*);
