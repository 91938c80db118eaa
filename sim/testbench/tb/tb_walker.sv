// SPDX-License-Identifier: Apache-2.0
// slog_walker with step_o.valid as a separate port: the other fields are undefined before the first step.
module tb_walker #(
    parameter  int unsigned Pitch       = 4,
    parameter  int unsigned RingRows    = 32,
    parameter  int unsigned DrainClocks = 14,
    localparam int unsigned RowW        = $clog2(RingRows) + 1
) (
    input  logic                  clk_i,
    input  logic                  rst_i,
    input  logic                  row_valid_i,
    output logic                  row_ready_o,
    input  slog_fetch_pkg::row_t  row_i,
    output logic                  step_valid_o,
    output slog_pkg::step_t       step_o,
    output logic [RowW-1:0]       rows_freed_o,
    output logic                  bank_free_o,
    output logic                  busy_o,
    output logic                  drained_o
);
  slog_pkg::step_t step;
  always_comb begin
    step_o       = step;
    step_o.valid = 1'b0;
  end
  assign step_valid_o = step.valid;

  slog_walker #(
      .Pitch      (Pitch),
      .RingRows   (RingRows),
      .DrainClocks(DrainClocks)
  ) u_dut (
      .step_o(step),
      .*
  );
endmodule : tb_walker
