// `slog_reset` on the ECP5: one of the global networks that carry clocks carries the reset to the registers.
//
// Latency, rules: those of ../slog_reset.sv. The network adds about as much to the path as it does to the clock's.
module slog_reset (
    input  logic clk_i,
    input  logic rst_i,
    output logic rst_o
);
  logic rst_q = 1'b1;
  logic rst_q2 = 1'b1;
  logic rst_q3 = 1'b1;

  always_ff @(posedge clk_i) begin
    rst_q  <= rst_i;
    rst_q2 <= rst_q;
    rst_q3 <= rst_q2;
  end

  DCCA u_global (.CLKI(rst_q3), .CE(1'b1), .CLKO(rst_o));
endmodule : slog_reset
