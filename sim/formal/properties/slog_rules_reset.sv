// SPDX-License-Identifier: Apache-2.0
// Assumption of every proof with a reset: from power-up on rst_i is held for Clocks clocks, and so is every later reset.
module slog_rules_reset #(
    parameter int unsigned Clocks = 1
) (
    input logic clk_i,
    input logic rst_i
);
  localparam int unsigned CountW = $clog2(Clocks + 1);
  logic [CountW-1:0] owed_q = CountW'(Clocks);  // clocks of the reset under way that are still to come

  always_ff @(posedge clk_i) begin
    if (owed_q != '0) owed_q <= owed_q - 1'b1;
    else if (rst_i) owed_q <= CountW'(Clocks - 1);
    AssumeReset : assume (owed_q == '0 || rst_i);
    AssumeCount : assume (32'(owed_q) <= Clocks);
  end
endmodule : slog_rules_reset
