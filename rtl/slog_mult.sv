// Signed multiplier with three register stages, as a hard multiplier block has them.
//
//   p = a * b
//
//   stage  registers, all moving while en_i is high
//   1      operands
//   2      product
//   3      product, output
// Latency    : 3 clocks with en_i high, the operands' own the first.
// Throughput : one product per clock.
// Formats    : two's complement, 18 x 18 -> 36 bits, exact.
// One enable: a block of four hard multipliers has room for four different ones, its own and its neighbours'.
// Twin       : ecp5/slog_mult.sv is the same module on the ECP5's multiplier block.
module slog_mult (
    input  logic               clk_i,
    input  logic               en_i,
    input  logic signed [17:0] a_i,
    input  logic signed [17:0] b_i,
    output logic signed [35:0] p_o
);
  logic signed [17:0] a_q, b_q;
  logic signed [35:0] p_q, p_q2;

  always_ff @(posedge clk_i) begin
    if (en_i) begin
      a_q  <= a_i;
      b_q  <= b_i;
      p_q  <= 36'(longint'(a_q) * longint'(b_q));  // a machine word: simulates faster than 36 bits
      p_q2 <= p_q;
    end
  end
  assign p_o = p_q2;
endmodule : slog_mult
