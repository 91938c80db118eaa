// SPDX-License-Identifier: Apache-2.0
// One kernel of slog_fir: multiplies the folded window and adds up, with its own registers close to its multipliers.
//
// sum_o = Bias + sum over d = 0..Radius of coef_i[d] * fold_i[d]
//
// Stages     : 1 operands    2..4 multiply    5 terms, because the multipliers lie far from the adders    then
//              clog2(Radius + 2) levels of adders, one more register before the last two, because the terms lie far apart
// Latency    : 6 + clog2(Radius + 2) clocks from fold_i to sum_o.
// Throughput : one fold per clock.
// Rules      : en_i is low only in clocks in which none of stages 1..3 holds a valid value. coef_i is constant from the clock
//              before a valid fold_i until its product is computed. slog_fir ensures both; it has the valid bits.
// Formats    : fold in machine words, which simulate fast: FoldW bits are used, signed if FoldW is 18, else unsigned;
//              coefficients 18-bit signed; sum modulo 2**SumW, SumW <= 36.
`include "slog_assert.svh"
module slog_fir_kernel #(
    parameter  int unsigned Radius = 8,
    parameter  int unsigned FoldW  = 9,
    parameter  int unsigned SumW   = 25,
    parameter  int          Bias   = 0,
    localparam int unsigned Levels = $clog2(Radius + 2)
) (
    input  logic                  clk_i,
    input  logic                  en_i,
    input  logic [Radius:0][31:0] fold_i,
    input  logic [Radius:0][17:0] coef_i,
    output logic [SumW-1:0]       sum_o
);
  localparam int unsigned Terms = Radius + 2;  // the taps and the bias
  localparam logic [31:0] Used  = (32'd1 << FoldW) - 32'd1;

  // Terms left after `level` levels of pairwise addition.
  function automatic int unsigned terms(int unsigned level);
    return (Terms + (1 << level) - 1) >> level;
  endfunction

  logic [Radius:0][31:0] fold_q;
  always_ff @(posedge clk_i) fold_q <= fold_i & {(Radius + 1) {Used}};

  for (genvar d = 0; d <= Radius; d++) begin : g_tap
    logic [35:0] product;
    logic [SumW-1:0] term;
    always_ff @(posedge clk_i) term <= product[SumW-1:0];
    slog_mult u_mult (
        .clk_i,
        .en_i,
        .a_i (fold_q[d][17:0]),
        .b_i (coef_i[d]),
        .p_o (product)
    );
  end

  for (genvar l = 0; l < Levels; l++) begin : g_level
    for (genvar i = 0; i < terms(l + 1); i++) begin : g_node
      logic [SumW-1:0] sum, sum_q, term;
      if (l > 0) begin : g_inner
        if (2 * i + 1 < terms(l)) begin : g_pair
          assign sum = g_level[l-1].g_node[2*i].term + g_level[l-1].g_node[2*i+1].term;
        end else begin : g_single
          assign sum = g_level[l-1].g_node[2*i].term;
        end
      end else begin : g_leaf
        if (2 * i + 1 <= Radius) begin : g_pair
          assign sum = g_tap[2*i].term + g_tap[2*i+1].term;
        end else if (2 * i == Radius) begin : g_bias
          assign sum = g_tap[2*i].term + SumW'(Bias);
        end else begin : g_single
          assign sum = SumW'(Bias);
        end
      end
      always_ff @(posedge clk_i) sum_q <= sum;
      if (l + 3 == Levels) begin : g_far
        logic [SumW-1:0] sum_q2;
        always_ff @(posedge clk_i) sum_q2 <= sum_q;
        assign term = sum_q2;
      end else begin : g_near
        assign term = sum_q;
      end
    end
  end
  assign sum_o = g_level[Levels-1].g_node[0].term;

  `SLOG_ASSERT_INIT(SlogFirKernelWidths, SumW <= 36 && FoldW <= 18 && Levels > 2)
endmodule : slog_fir_kernel
