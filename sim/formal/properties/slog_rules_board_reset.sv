// SPDX-License-Identifier: Apache-2.0
// slog_reset: the board's reset lasts Held clocks or more, begins with power-up, and ends after the pin's.
module slog_rules_board_reset #(
    parameter int unsigned Held = 4
) (
    input logic clk_i,
    input logic rst_i,
    input logic rst_o
);
  logic [7:0] past_q = '0;      // [k]: rst_i k + 1 clocks ago
  logic [4:0] held_q = '0;      // clocks for which rst_o has been high
  logic [4:0] age_q = '0;
  always_ff @(posedge clk_i) begin
    past_q <= {past_q[6:0], rst_i};
    held_q <= !rst_o ? '0 : (held_q == '1) ? held_q : held_q + 1'b1;
    age_q  <= (age_q == '1) ? age_q : age_q + 1'b1;
    RulesResetPowerUp : assert (32'(age_q) >= Held || rst_o);
    RulesResetFollows : assert (!past_q[3] || rst_o);
    RulesResetLasts : assert (rst_o || held_q == '0 || 32'(held_q) >= Held);
    RulesResetEnds : assert (32'(age_q) < Held + 4 || past_q[Held+2:0] != '0 || !rst_o);
    CoverAgain : cover (rst_o && held_q == '0 && 32'(age_q) > Held);
  end
endmodule : slog_rules_board_reset

bind slog_reset slog_rules_board_reset #(.Held(Held)) u_rules (.*);
