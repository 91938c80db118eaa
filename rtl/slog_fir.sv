// Symmetric FIR; one or two kernels over the same window.
//
// fold[0] = w[R],  fold[d] = w[R - d] + w[R + d]   (w = window_i, R = Radius)
// sum_o[k] = Bias + sum over d = 0..R of coef_i[k][d] * fold[d]
//
// Stages     : 1 fold    2..4 multiply    then clog2(Radius + 2) levels of adders
// Latency    : 4 + clog2(Radius + 2) clocks from valid_i, with the window, to sum_o.
// Throughput : one window per clock. sum_o holds until the next valid window's sum.
// Formats    : window in fields of DataW bits, two's complement in the lower 18 of them, or if less unsigned; fold modulo
//              2**18; coefficients 18-bit signed, constant from a valid window's clock as long as anything is under
//              way; sums modulo 2**SumW, SumW <= 36.
`include "slog_assert.svh"
module slog_fir #(
    parameter  int unsigned Radius  = 8,
    parameter  int unsigned DataW   = 8,
    parameter  int unsigned Kernels = 2,
    parameter  int unsigned SumW    = 25,
    parameter  int          Bias    = 0,
    localparam int unsigned Taps    = 2 * Radius + 1,
    localparam int unsigned Levels  = $clog2(Radius + 2),
    localparam int unsigned Latency = 4 + Levels
) (
    input  logic                               clk_i,
    input  logic                               rst_i,
    input  logic                               valid_i,
    input  logic [Taps-1:0][DataW-1:0]         window_i,
    input  logic [Kernels-1:0][Radius:0][17:0] coef_i,
    output logic [Kernels-1:0][SumW-1:0]       sum_o
);
  localparam int unsigned Terms = Radius + 2;  // the taps and the bias

  // Terms left after `level` levels of pairwise addition.
  function automatic int unsigned terms(int unsigned level);
    return (Terms + (1 << level) - 1) >> level;
  endfunction

  logic [Latency-2:0] valid_q;  // [k]: stage k + 1 holds something
  logic               mult;     // the multipliers or their operands hold something
  assign mult = valid_q[2:0] != '0;
  always_ff @(posedge clk_i) begin
    if (rst_i) valid_q <= '0;
    else valid_q <= {valid_q[Latency-3:0], valid_i};
  end

  // The multipliers lie far apart: what goes there comes from registers. In machine words, which simulate fast.
  logic [Radius:0][31:0] fold, fold_q;
  always_comb begin
    fold[0] = 32'(18'(window_i[Radius]));
    for (int unsigned d = 1; d <= Radius; d++) fold[d] = 32'(18'(window_i[Radius-d]) + 18'(window_i[Radius+d]));
  end
  always_ff @(posedge clk_i) fold_q <= fold;

  for (genvar k = 0; k < Kernels; k++) begin : g_kernel
    for (genvar d = 0; d <= Radius; d++) begin : g_tap
      logic [35:0] product;
      logic [SumW-1:0] term;
      assign term = product[SumW-1:0];
      slog_mult u_mult (
          .clk_i,
          .en_i(mult),
          .a_i (fold_q[d][17:0]),
          .b_i (coef_i[k][d]),
          .p_o (product)
      );
    end

    for (genvar l = 0; l < Levels; l++) begin : g_level
      for (genvar i = 0; i < terms(l + 1); i++) begin : g_node
        logic [SumW-1:0] sum, sum_q;
        if (l > 0) begin : g_inner
          if (2 * i + 1 < terms(l)) begin : g_pair
            assign sum = g_level[l-1].g_node[2*i].sum_q + g_level[l-1].g_node[2*i+1].sum_q;
          end else begin : g_single
            assign sum = g_level[l-1].g_node[2*i].sum_q;
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
        if (l == Levels - 1) begin : g_out
          always_ff @(posedge clk_i) if (valid_q[l+3]) sum_q <= sum;
        end else begin : g_register
          always_ff @(posedge clk_i) sum_q <= sum;
        end
      end
    end
    assign sum_o[k] = g_level[Levels-1].g_node[0].sum_q;
  end

  `SLOG_ASSERT(SlogFirCoefficientsStatic, mult |-> $stable(coef_i))
  `SLOG_ASSERT_INIT(SlogFirWidths, SumW <= 36)
endmodule : slog_fir
