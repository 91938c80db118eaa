// SPDX-License-Identifier: Apache-2.0
// slog_accumulator against its equation, in every lane: a row's total is the total before, or 0, plus its count and extra.
//
// The bits of a number come one move apart; a move is a clock with move_i. The equation is checked after enough moves in
// a row; that nothing changes without move_i is checked apart, so that pauses anywhere make no difference.
module slog_rules_accumulator #(
    parameter int unsigned CountBits = 2,
    parameter int unsigned ScoreBits = 4,
    parameter int unsigned Lanes     = 2
) (
    input logic                 clk_i,
    input logic                 move_i,
    input logic                 first_i,
    input logic                 extra_i[Lanes],
    input logic [CountBits-1:0] count_i[Lanes],
    input logic [ScoreBits-1:0] total_o[Lanes],
    input logic [ScoreBits-1:0] first_q[Lanes],
    input logic [ScoreBits-1:0] total_q[Lanes],
    input logic [ScoreBits-1:0] carry_q[Lanes],
    input logic [CountBits-1:0] count_q[Lanes],
    input logic                 extra_q[Lanes]
);
  localparam int unsigned Last = ScoreBits + 2;  // moves from a lane's extra to its total's top bit
  localparam int unsigned Deep = Last + Lanes;
  // [k]: k moves ago; of every lane and bit.
  logic [Deep:0] first, past_first_q;
  logic [Lanes-1:0][Deep:0] extra, past_extra_q;
  logic [Lanes-1:0][CountBits-1:0][Deep:0] count, past_count_q;
  logic [Lanes-1:0][ScoreBits-1:0][Deep:0] total, past_total_q;
  logic [5:0] run_q = '0;      // moves in a row
  logic held_q = 1'b0;         // no move in the clock before
  logic [Lanes-1:0][3*ScoreBits+CountBits:0] state, state_q;
  logic [Lanes-1:0][ScoreBits-1:0] found, wanted;

  always_comb begin
    first = {past_first_q[Deep-1:0], first_i};
    for (int unsigned k = 0; k < Lanes; k++) begin
      state[k] = {first_q[k], total_q[k], carry_q[k], count_q[k], extra_q[k]};
      extra[k] = {past_extra_q[k][Deep-1:0], extra_i[k]};
      for (int unsigned i = 0; i < CountBits; i++) count[k][i] = {past_count_q[k][i][Deep-1:0], count_i[k][i]};
      for (int unsigned i = 0; i < ScoreBits; i++) total[k][i] = {past_total_q[k][i][Deep-1:0], total_o[k][i]};
      wanted[k] = ScoreBits'(extra[k][Last]);
      for (int unsigned i = 0; i < CountBits; i++) wanted[k] += ScoreBits'(count[k][i][Last-1-i]) << i;
      for (int unsigned i = 0; i < ScoreBits; i++) begin
        found[k][i] = total[k][i][ScoreBits-1-i];
        if (!first[Last+k-1]) wanted[k] += ScoreBits'(total[k][i][ScoreBits-i]) << i;
      end
    end
  end
  always_ff @(posedge clk_i) begin
    held_q  <= !move_i;
    state_q <= state;
    if (!move_i) run_q <= '0;
    else if (run_q != '1) run_q <= run_q + 1'b1;
    if (move_i) begin
      past_first_q <= first;
      past_extra_q <= extra;
      past_count_q <= count;
      past_total_q <= total;
    end
    RulesAccumulator : assert (32'(run_q) <= Deep + 1 || found == wanted);
    RulesAccumulatorHolds : assert (!held_q || state == state_q);
    CoverSum : cover (32'(run_q) > Deep + 1 && found[Lanes-1] == '1 && !first[Last+Lanes-2] && extra[Lanes-1][Last]);
  end
endmodule : slog_rules_accumulator

bind slog_accumulator slog_rules_accumulator #(.CountBits(CountBits), .ScoreBits(ScoreBits), .Lanes(Lanes)) u_rules (.*);
