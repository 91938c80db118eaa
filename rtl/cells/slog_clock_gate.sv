// SPDX-License-Identifier: Apache-2.0
// Stops an idle block's clock in the fast simulation build (SLOG_CLOCK_GATE).
//
// The block's clock runs while active_i is high and for Linger clocks after. active_i must be chosen so that no register
// of the block changes in any other clock. Without SLOG_CLOCK_GATE the clock passes through, and the logic that drives
// active_i is optimised away.
// Reset      : rst_i is held for 1 clock or more.
module slog_clock_gate #(
    parameter  int unsigned Linger  = 64,
    localparam int unsigned LingerW = $clog2(Linger + 1)
) (
    input  logic clk_i,
    input  logic rst_i,
    input  logic active_i,
    output logic clk_o
);
`ifdef SLOG_CLOCK_GATE
  logic [LingerW-1:0] linger_q;
  logic enable;

  always_ff @(posedge clk_i) begin
    if (rst_i || active_i) linger_q <= LingerW'(Linger);
    else if (linger_q != '0) linger_q <= linger_q - 1'b1;
  end

  // Changes only while the clock is low, so that the gated clock has no glitch.
  always_latch begin
    if (!clk_i) enable = rst_i || active_i || linger_q != '0;
  end
  assign clk_o = clk_i && enable;
`else
  assign clk_o = clk_i;
`endif
endmodule : slog_clock_gate
