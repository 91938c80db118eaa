// SPDX-License-Identifier: Apache-2.0
// For the induction of SlogEmitZero: what is on its way through slog_emit is on its way through its valid flags.
//
// A token at bit i of any lane, and what it has taken along in the stages behind it, is as many moves old as the valid flag
// with the same number. After a reset this holds from that number of moves on. The copies of more_q agree.
module slog_rules_emit_zero #(
    parameter int unsigned ScoreBits = 3,
    parameter int unsigned Lanes     = 5,
    parameter int unsigned LaneW     = 3,
    parameter int unsigned Copies    = 2,
    parameter int unsigned Fews      = 1
) (
    input logic                                clk_i,
    input logic                                rst_i,
    input logic [Copies-1:0]                   more_q,
    input logic [Copies-1:0][LaneW-1:0]        left_q,
    input logic [ScoreBits+2:0]                valid_q,
    input logic [ScoreBits-1:0]                token_q[Lanes],
    input logic [ScoreBits-1:0]                pair_q[4*Fews],
    input logic [ScoreBits-1:0]                few_q[Fews],
    input logic [ScoreBits-1:0]                word_q,
    input logic [ScoreBits-1:0][ScoreBits-1:0] deskewed,   // [i]: bits of g_deskew[i]
    input int unsigned                         moves_since_reset
);
  // [i]: any lane, pair or group of pairs has bit i.
  logic [ScoreBits-1:0] token, pair, few;
  logic copies, stages;        // the copies agree; nothing is behind a flag that is gone
  logic [ScoreBits+2:0] gone;  // [i]: valid_q[i] is low, and everything as old as it came after the reset

  always_comb begin
    token = '0;
    pair  = '0;
    few   = '0;
    for (int unsigned k = 0; k < Lanes; k++) token |= token_q[k];
    for (int unsigned k = 0; k < 4 * Fews; k++) pair |= pair_q[k];
    for (int unsigned k = 0; k < Fews; k++) few |= few_q[k];
    for (int unsigned i = 0; i < ScoreBits + 3; i++) gone[i] = !valid_q[i] && moves_since_reset > i;
    copies = 1'b1;
    stages = 1'b1;
    for (int unsigned c = 1; c < Copies; c++) copies &= !more_q[c] || (more_q[c-1] && left_q[c] == left_q[c-1]);
    for (int unsigned i = 0; i < ScoreBits; i++) begin
      stages &= !(gone[i] && token[i]) && !(gone[i+1] && pair[i]) && !(gone[i+2] && few[i]) && !(gone[i+3] && word_q[i])
                && !(gone[i+3] && deskewed[i] != '0);
    end
  end

  always_ff @(posedge clk_i) begin
    if (!rst_i) begin
      RulesEmitZeroCount : assert (moves_since_reset <= ScoreBits + 4);
      RulesEmitZeroCopies : assert (copies);
      RulesEmitZeroStages : assert (stages);
    end
  end
endmodule : slog_rules_emit_zero

bind slog_emit slog_rules_emit_zero #(
    .ScoreBits(ScoreBits), .Lanes(Lanes), .LaneW(LaneW), .Copies(Copies), .Fews(Fews)
) u_rules_zero (.*, .deskewed({ScoreBits'(g_deskew[2].bits), ScoreBits'(g_deskew[1].bits), ScoreBits'(g_deskew[0].bits)}));
