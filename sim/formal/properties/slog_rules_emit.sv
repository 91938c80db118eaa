// SPDX-License-Identifier: Apache-2.0
// slog_emit against its definition: k clocks after lane 0's, lane k's total is output, of as many lanes as the pass has.
//
// Checked after enough moves (clocks with move_i) in a row since a reset; that nothing changes without move_i is checked
// apart.
module slog_rules_emit #(
    parameter int unsigned ScoreBits = 3,
    parameter int unsigned Lanes     = 5,
    parameter int unsigned LaneW     = 3,
    parameter int unsigned Copies    = 2
) (
    input logic                         clk_i,
    input logic                         rst_i,
    input logic                         move_i,
    input logic                         last_i,
    input logic [LaneW-1:0]             lanes_i,
    input logic [ScoreBits-1:0]         total_i[Lanes],
    input logic                         mismatch_valid_o,
    input logic [ScoreBits-1:0]         mismatch_o,
    input logic [Copies-1:0]            more_q,
    input logic [Copies-1:0][LaneW-1:0] left_q,
    input logic [ScoreBits+2:0]         valid_q
);
  localparam int unsigned First = 3 + ScoreBits;  // moves from last_i to lane 0's score
  localparam int unsigned Deep  = First + Lanes;
  // [k]: k moves ago.
  logic [Deep:0] last, past_last_q;
  logic [Deep:0][LaneW-1:0] lanes, past_lanes_q;
  logic [Lanes-1:0][ScoreBits-1:0][Deep:0] total, past_total_q;
  logic [5:0] run_q = '0;
  logic held_q = 1'b0;
  logic [ScoreBits:0] out_q;
  logic [ScoreBits+2+Copies*(LaneW+1):0] state, state_q;
  logic valid;
  logic [ScoreBits-1:0] wanted;

  assign state = {more_q, left_q, valid_q};
  always_comb begin
    last   = {past_last_q[Deep-1:0], last_i};
    lanes  = {past_lanes_q[Deep-1:0], lanes_i};
    valid  = 1'b0;
    wanted = '0;
    for (int unsigned k = 0; k < Lanes; k++) begin
      for (int unsigned i = 0; i < ScoreBits; i++) total[k][i] = {past_total_q[k][i][Deep-1:0], total_i[k][i]};
      if (last[First+k] && 32'(lanes[First+k]) > k) begin
        valid = 1'b1;
        for (int unsigned i = 0; i < ScoreBits; i++) wanted[i] = total[k][i][ScoreBits+2-i];
      end
    end
  end
  always_ff @(posedge clk_i) begin
    held_q  <= !move_i && !rst_i;
    out_q   <= {mismatch_valid_o, mismatch_o};
    state_q <= state;
    if (!move_i || rst_i) run_q <= '0;
    else if (run_q != '1) run_q <= run_q + 1'b1;
    if (move_i) begin
      past_last_q  <= last;
      past_lanes_q <= lanes;
      past_total_q <= total;
    end
    if (!rst_i) begin
      RulesEmitScore : assert (32'(run_q) <= Deep + ScoreBits + Lanes || {mismatch_valid_o, mismatch_o} == {valid, wanted});
      RulesEmitHolds : assert (!held_q || (state == state_q && {mismatch_valid_o, mismatch_o} == out_q));
      RulesEmitLeft : assert (!more_q[0] || (left_q[0] != '0 && 32'(left_q[0]) < Lanes));
      CoverAll : cover (32'(run_q) > Deep + ScoreBits + Lanes && valid && last[First+Lanes-1] && last[First-1]
                        && wanted == '1);
    end
  end
endmodule : slog_rules_emit

bind slog_emit slog_rules_emit #(.ScoreBits(ScoreBits), .Lanes(Lanes), .LaneW(LaneW), .Copies(Copies)) u_rules (.*);
