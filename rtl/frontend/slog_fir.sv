// SPDX-License-Identifier: Apache-2.0
// Symmetric FIR; one or two kernels over the same window.
//
// fold[0] = w[R],  fold[d] = w[R - d] + w[R + d]   (w = window_i, R = Radius)
// sum_o[k] = Bias + sum over d = 0..R of coef_i[k][d] * fold[d]
//
// Stages     : 1 fold    then slog_fir_kernel: 2 operands    3..5 multiply    6 terms    clog2(Radius + 2) levels of
//              adders, and 1, or 2 for sums of more than 24 bits
// Latency    : 7 + clog2(Radius + 2) clocks from valid_i and window_i to sum_o, one more with SumW > 24; sum_o is undefined
//              in other clocks.
// Throughput : one window per clock.
// Formats    : window in fields of DataW bits: two's complement in the lower 18 if DataW >= 18, else unsigned; fold modulo
//              2**18; coefficients 18-bit signed, constant from the clock of a valid window until its multiplication is
//              done; sums modulo 2**SumW, SumW <= 36. Radius is 3 or more.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_fir #(
    parameter  int unsigned Radius  = 8,
    parameter  int unsigned DataW   = 8,
    parameter  int unsigned Kernels = 2,
    parameter  int unsigned SumW    = 25,
    parameter  int          Bias    = 0,
    localparam int unsigned Taps    = 2 * Radius + 1
) (
    input  logic                               clk_i,
    input  logic                               rst_i,
    input  logic                               valid_i,
    input  logic [Taps-1:0][DataW-1:0]         window_i,
    input  logic [Kernels-1:0][Radius:0][17:0] coef_i,
    output logic [Kernels-1:0][SumW-1:0]       sum_o
);
  localparam int unsigned FoldW = (DataW < 18) ? DataW + 1 : 18;

  logic [3:0] valid_q;  // [k]: stage k + 1 holds a valid value
  logic       mult;     // the multipliers or their operands hold a valid value
  assign mult = valid_q[3:1] != '0;
  always_ff @(posedge clk_i) begin
    if (rst_i) valid_q <= '0;
    else valid_q <= {valid_q[2:0], valid_i};
  end

  // The kernels lie far apart: registers drive their inputs. Fields are machine words, which simulate fast.
  logic [Radius:0][31:0] fold, fold_q;
  always_comb begin
    fold[0] = 32'(18'(window_i[Radius]));
    for (int unsigned d = 1; d <= Radius; d++) fold[d] = 32'(18'(window_i[Radius-d]) + 18'(window_i[Radius+d]));
  end
  always_ff @(posedge clk_i) fold_q <= fold;

  for (genvar k = 0; k < Kernels; k++) begin : g_kernel
    slog_fir_kernel #(
        .Radius(Radius),
        .FoldW (FoldW),
        .SumW  (SumW),
        .Bias  (Bias)
    ) u_kernel (
        .clk_i,
        .en_i  (mult),
        .fold_i(fold_q),
        .coef_i(coef_i[k]),
        .sum_o (sum_o[k])
    );
  end

  `SLOG_PAST(past_coef, coef_i)
  `SLOG_ASSERT(SlogFirCoefficientsStatic, valid_q == '0 || coef_i == past_coef)
endmodule : slog_fir
