// Symmetric FIR over a window with border replacement; one or two kernels over the same window.
//
// w[i] = past the border ? edge : window_i[i];   fold[0] = w[R],  fold[d] = w[R + d] + w[R - d]   (R = Radius)
// sum_o[k] = Bias + sum over d = 0..R of coef_i[k][d] * fold[d]
//
// Stages     : 1 replace, fold    2..4 multiply    then clog2(Radius + 2) levels of adders
// Latency    : 4 + clog2(Radius + 2) clocks from valid_i to sum_o.
// Throughput : one window per clock. Registers move only when something valid moves through them.
// Formats    : window DataW bits, unsigned or (Signed) two's complement; coefficients 18-bit signed, index = distance
//              from the centre, constant while anything is under way; sums modulo 2**SumW, SumW <= 36.
`include "slog_assert.svh"
module slog_fir #(
    parameter  int unsigned Radius  = 8,
    parameter  int unsigned DataW   = 8,
    parameter  bit          Signed  = 1'b0,
    parameter  int unsigned Kernels = 2,
    parameter  int unsigned SumW    = 25,
    parameter  int          Bias    = 0,
    localparam int unsigned Taps    = 2 * Radius + 1,
    localparam int unsigned Levels  = $clog2(Radius + 2),
    localparam int unsigned Latency = 4 + Levels
) (
    input  logic                                 clk_i,
    input  logic                                 rst_i,
    input  logic                                 valid_i,
    input  logic [DataW-1:0]                     window_i[Taps],
    input  logic [DataW-1:0]                     edge_i,
    input  logic [Radius-1:0]                    beyond_old_i,
    input  logic [Radius-1:0]                    beyond_new_i,
    input  logic [Kernels-1:0][Radius:0][17:0]   coef_i,
    output logic [SumW-1:0]                      sum_o[Kernels]
);
  localparam int unsigned Terms = Radius + 2;  // the taps and the bias

  // Terms left after `level` levels of pairwise addition.
  function automatic int unsigned terms(int unsigned level);
    return (Terms + (1 << level) - 1) >> level;
  endfunction

  logic [Latency-2:0] valid_q;  // [k]: stage k + 1 holds something
  always_ff @(posedge clk_i) begin
    if (rst_i) valid_q <= '0;
    else valid_q <= {valid_q[Latency-3:0], valid_i};
  end

  function automatic logic [17:0] extend(logic [DataW-1:0] data);
    return {{(18 - DataW) {Signed && data[DataW-1]}}, data};
  endfunction

  logic [17:0] fold_q[Radius+1];
  always_ff @(posedge clk_i) begin
    if (valid_i) fold_q[0] <= extend(window_i[Radius]);
  end
  for (genvar d = 1; d <= Radius; d++) begin : g_fold
    always_ff @(posedge clk_i) begin
      if (valid_i) begin
        fold_q[d] <= extend(beyond_old_i[d-1] ? edge_i : window_i[Radius+d])
                     + extend(beyond_new_i[d-1] ? edge_i : window_i[Radius-d]);
      end
    end
  end

  for (genvar k = 0; k < Kernels; k++) begin : g_kernel
    logic [35:0] product[Radius+1];
    for (genvar d = 0; d <= Radius; d++) begin : g_tap
      slog_mult u_mult (
          .clk_i,
          .en_i(valid_q[2:0]),
          .a_i (fold_q[d]),
          .b_i (coef_i[k][d]),
          .p_o (product[d])
      );
    end

    for (genvar l = 0; l < Levels; l++) begin : g_level
      localparam int unsigned In = terms(l);
      logic [SumW-1:0] sum_q[terms(l+1)];
      for (genvar i = 0; i < terms(l + 1); i++) begin : g_node
        logic [SumW-1:0] sum;
        if (l > 0) begin : g_inner
          if (2 * i + 1 < In) begin : g_pair
            assign sum = g_level[l-1].sum_q[2*i] + g_level[l-1].sum_q[2*i+1];
          end else begin : g_single
            assign sum = g_level[l-1].sum_q[2*i];
          end
        end else begin : g_leaf
          if (2 * i + 1 <= Radius) begin : g_pair
            assign sum = product[2*i][SumW-1:0] + product[2*i+1][SumW-1:0];
          end else if (2 * i == Radius) begin : g_bias
            assign sum = product[2*i][SumW-1:0] + SumW'(Bias);
          end else begin : g_single
            assign sum = SumW'(Bias);
          end
        end
        always_ff @(posedge clk_i) begin
          if (valid_q[l+3]) sum_q[i] <= sum;
        end
      end
    end
    assign sum_o[k] = g_level[Levels-1].sum_q[0];
  end

  `SLOG_ASSERT_INIT(SlogFirWidths, DataW <= 18 - 32'(Signed) && SumW <= 36)
endmodule : slog_fir
