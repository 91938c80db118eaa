// SPDX-License-Identifier: Apache-2.0
// One kernel of slog_fir: multiplies the folded window and adds up, with its own registers close to its multipliers.
//
// sum_o = Bias + sum over d = 0..Radius of coef_i[d] * fold_i[d]
//
// Stages     : 1 operands    2..4 multiply    5 terms, because the multipliers lie far from the adders    then slog_fir_tree:
//              clog2(Radius + 2) + 1. Sums of more than 24 bits are added in halves, the upper one a clock later, with the
//              carries of the lower one: a chain of carries as long as the sum would decide the clock.
// Latency    : 6 + clog2(Radius + 2) clocks from fold_i to sum_o, and one more with halves.
// Throughput : one fold per clock.
// Rules      : en_i is low only in clocks in which none of stages 1..3 holds a valid value. coef_i is constant from the clock
//              of a valid fold_i until its product is computed. slog_fir ensures both; it has the valid bits. Radius is 3
//              or more.
// Formats    : fold in machine words, which simulate fast: FoldW bits are used, signed if FoldW is 18, else unsigned;
//              coefficients 18-bit signed; sum modulo 2**SumW, SumW <= 36.
`include "slog_assert.svh"
module slog_fir_kernel #(
    parameter int unsigned Radius = 8,
    parameter int unsigned FoldW  = 9,
    parameter int unsigned SumW   = 25,
    parameter int          Bias   = 0
) (
    input  logic                  clk_i,
    input  logic                  en_i,
    input  logic [Radius:0][31:0] fold_i,
    input  logic [Radius:0][17:0] coef_i,
    output logic [SumW-1:0]       sum_o
);
  localparam int unsigned Terms = Radius + 2;  // the taps and the bias
  localparam bit Halves         = SumW > 24;
  localparam int unsigned LowW  = Halves ? SumW / 2 : SumW;
  localparam int unsigned HighW = SumW - LowW;
  localparam logic [31:0] Used  = (32'd1 << FoldW) - 32'd1;

  logic [Radius:0][31:0] fold_q;
  always_ff @(posedge clk_i) fold_q <= fold_i & {(Radius + 1) {Used}};

  // The terms, the bias last, in halves or whole: machine words again.
  logic [Terms-1:0][31:0] low_q;
  logic [LowW-1:0] low_sum;
  /* verilator lint_off UNUSEDSIGNAL */
  logic [Terms-1:0][31:0] high_q2;
  logic [Terms-2:0] carry /* verilator split_var */;  // of the lower half; a whole sum's are dropped
  /* verilator lint_on UNUSEDSIGNAL */
  for (genvar d = 0; d <= Radius; d++) begin : g_tap
    logic [35:0] product;
    always_ff @(posedge clk_i) low_q[d] <= 32'(product[LowW-1:0]);
    slog_mult u_mult (
        .clk_i,
        .en_i,
        .a_i (fold_q[d][17:0]),
        .b_i (coef_i[d]),
        .p_o (product)
    );
    if (Halves) begin : g_high
      logic [HighW-1:0] high_q;
      always_ff @(posedge clk_i) begin
        high_q     <= product[SumW-1:LowW];
        high_q2[d] <= 32'(high_q);
      end
    end else begin : g_whole
      assign high_q2[d] = '0;
    end
  end
  assign low_q[Radius+1]   = 32'(LowW'(Bias));
  assign high_q2[Radius+1] = 32'(SumW'(Bias) >> LowW);

  slog_fir_tree #(
      .Terms  (Terms),
      .SumW   (LowW),
      .CarryIn(1'b0)
  ) u_low (
      .clk_i,
      .term_i (low_q),
      .carry_i('0),
      .carry_o(carry),
      .sum_o  (low_sum)
  );

  if (Halves) begin : g_halves
    logic [HighW-1:0] high_sum;
    logic [LowW-1:0] low_sum_q;
    always_ff @(posedge clk_i) low_sum_q <= low_sum;
    /* verilator lint_off PINCONNECTEMPTY */
    slog_fir_tree #(
        .Terms(Terms),
        .SumW (HighW)
    ) u_high (
        .clk_i,
        .term_i (high_q2),
        .carry_i(carry),
        .carry_o(),
        .sum_o  (high_sum)
    );
    /* verilator lint_on PINCONNECTEMPTY */
    assign sum_o = {high_sum, low_sum_q};
  end else begin : g_whole
    assign sum_o = low_sum;
  end

  `SLOG_ASSERT_INIT(SlogFirKernelWidths, SumW <= 36 && FoldW <= 18)
endmodule : slog_fir_kernel
