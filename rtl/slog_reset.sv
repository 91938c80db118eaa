// A register on the way of a reset: of one block, beside it, kept apart from the others'.
//
// Latency    : 1 clock. At power-up there is a reset.
module slog_reset (
    input  logic clk_i,
    input  logic rst_i,
    output logic rst_o
);
  logic rst_q = 1'b1;

  always_ff @(posedge clk_i) rst_q <= rst_i;
  assign rst_o = rst_q;
endmodule : slog_reset
