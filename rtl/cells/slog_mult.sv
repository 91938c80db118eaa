// SPDX-License-Identifier: Apache-2.0
// Signed multiplier with three register stages, like those of a hard multiplier block.
//
//   p = a * b
//
//   stage  registers
//   1      operand a; b is a coefficient
//   2      product
//   3      product, output
// Latency    : 3 clocks. en_i must be high in all of them, the first being that of a_i.
// Throughput : one product per clock.
// Rules      : en_i low discards all products in the pipeline; p_o is undefined until three clocks after en_i rises again.
//              en_i only saves simulation time; the ECP5 twin ignores it. b_i is constant from the clock before en_i
//              rises until en_i falls, because the twin registers it.
// Formats    : two's complement, 18 x 18 -> 36 bits, exact.
// Twin       : ecp5/slog_mult.sv is the same module on the ECP5's multiplier block.
`include "slog_assert.svh"
module slog_mult (
    input  logic               clk_i,
    input  logic               en_i,
    input  logic signed [17:0] a_i,
    input  logic signed [17:0] b_i,
    output logic signed [35:0] p_o
);
  // Machine words: they simulate faster than 18 and 36 bits.
  int a_q, b_q;
  longint p_q;
  /* verilator lint_off UNUSEDSIGNAL */
  longint p_q2;
  /* verilator lint_on UNUSEDSIGNAL */

  always_ff @(posedge clk_i) begin
    if (en_i) begin
      a_q  <= 32'(a_i);
      p_q  <= longint'(a_q) * longint'(b_q);
      p_q2 <= p_q;
    end else begin
      b_q <= 32'(b_i);
    end
  end
  assign p_o = 36'(p_q2);

  `SLOG_PAST(past_b, b_i)
  `SLOG_ASSERT_NO_RESET(SlogMultCoefficientStable, !en_i || b_i == past_b)
endmodule : slog_mult
