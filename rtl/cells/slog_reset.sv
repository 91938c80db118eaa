// The board's reset from its pin to all registers: three registers, then a buffer for the net that spans the whole board.
//
// Latency    : 3 clocks. All three registers are set at power-up, so the board starts in reset.
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

  slog_reset_buffer u_buffer (.rst_i(rst_q3), .rst_o);
endmodule : slog_reset
