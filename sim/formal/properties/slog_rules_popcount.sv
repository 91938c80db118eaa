// SPDX-License-Identifier: Apache-2.0
// slog_popcount against the plain number of ones, in lane 0. History counts clocks in which move_i is high.
module slog_rules_popcount #(
    parameter int unsigned GroupBits = 4,
    parameter int unsigned Lanes     = 1,
    parameter int unsigned Levels    = 2
) (
    input logic                 clk_i,
    input logic                 move_i,
    input logic [GroupBits-1:0] a_i[Lanes],
    input logic [GroupBits-1:0] b_i[Lanes],
    input logic [Levels:0]      count_o[Lanes],
    input logic                 extra_o[Lanes]
);
  localparam int unsigned Last = 2 * Levels;  // latency of the top bit
  localparam int unsigned SumW = Levels + 2;
  logic [Last:1][SumW-1:0] ones_q;          // [k]: ones of the operands k moves ago
  logic [Levels:0][Last:0] bits_q;          // [i][k]: bit i of the count k moves ago
  logic [Levels+1:0] extra_q;               // [k]: extra_o k + 1 moves ago
  logic [4:0] moves_q = '0;
  logic [SumW-1:0] ones, found;
  always_comb begin
    ones = '0;
    for (int unsigned b = 0; b < GroupBits; b++) ones += SumW'(a_i[0][b]) + SumW'(b_i[0][b]);
    found = SumW'(extra_q[Levels]);
    for (int unsigned i = 0; i <= Levels; i++) begin
      found += SumW'((i == Levels) ? count_o[0][i] : bits_q[i][Levels-i-1]) << i;
    end
  end
  always_ff @(posedge clk_i) begin
    if (move_i) begin
      ones_q  <= {ones_q[Last-1:1], ones};
      extra_q <= {extra_q[Levels:0], extra_o[0]};
      for (int unsigned i = 0; i <= Levels; i++) bits_q[i] <= {bits_q[i][Last-1:0], count_o[0][i]};
      if (32'(moves_q) < Last) moves_q <= moves_q + 1'b1;
    end
    RulesPopcount : assert (32'(moves_q) < Last || found == ones_q[Last]);
    CoverAll : cover (32'(moves_q) == Last && 32'(found) == 2 * GroupBits);
  end
endmodule : slog_rules_popcount

bind slog_popcount slog_rules_popcount #(.GroupBits(GroupBits), .Lanes(Lanes), .Levels(Levels)) u_rules (.*);
