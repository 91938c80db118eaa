// SPDX-License-Identifier: Apache-2.0
// A constant that may be anything, the same on every clock: what is proved of it holds for every choice.
//
// Two registers that exchange their values and are assumed equal. One register that keeps its own value would not do:
// Yosys takes it for undefined, and it might then differ from one use to the next.
module slog_rules_choice #(
    parameter int unsigned Width = 1
) (
    input  logic             clk_i,
    output logic [Width-1:0] choice
);
  logic [Width-1:0] one_q, other_q;
  assign choice = one_q;
  always_ff @(posedge clk_i) begin
    one_q   <= other_q;
    other_q <= one_q;
    AssumeSame : assume (one_q == other_q);
  end
endmodule : slog_rules_choice
