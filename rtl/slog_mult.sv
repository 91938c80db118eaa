// Signed multiplier with three register stages, as a hard multiplier block has them.
//
//   p = a * b
//
//   stage  registers, moving when their enable is high
//   1      operands         en_i[0]
//   2      product          en_i[1]
//   3      product, output  en_i[2]
// Latency    : 3 clocks, with en_i[k] high in the k-th clock after the operands' own (k = 0, 1, 2).
// Throughput : one product per clock.
// Formats    : two's complement, 18 x 18 -> 36 bits, exact.
// Twin       : ecp5/slog_mult.sv is the same module on the ECP5's multiplier block.
module slog_mult (
    input  logic               clk_i,
    input  logic        [ 2:0] en_i,
    input  logic signed [17:0] a_i,
    input  logic signed [17:0] b_i,
    output logic signed [35:0] p_o
);
  logic signed [17:0] a_q, b_q;
  logic signed [35:0] p_q, p_q2;

  always_ff @(posedge clk_i) begin
    if (en_i[0]) begin
      a_q <= a_i;
      b_q <= b_i;
    end
    if (en_i[1]) p_q <= 36'(longint'(a_q) * longint'(b_q));  // a machine word: simulates faster than 36 bits
    if (en_i[2]) p_q2 <= p_q;
  end
  assign p_o = p_q2;
endmodule : slog_mult
