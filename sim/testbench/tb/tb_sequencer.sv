// SPDX-License-Identifier: Apache-2.0
// slog_sequencer with step_o.valid as a separate port: the other fields are undefined before the first step.
module tb_sequencer #(
    parameter  int unsigned GroupBits   = 8,
    parameter  int unsigned Pitch       = 4,
    parameter  int unsigned RingRows    = 32,
    parameter  int unsigned DrainClocks = 14,
    localparam int unsigned RowW        = $clog2(RingRows) + 1
) (
    input  logic                    clk_i,
    input  logic                    rst_i,
    input  logic                    ticket_valid_i,
    output logic                    ticket_ready_o,
    input  slog_fetch_pkg::ticket_t ticket_i,
    input  logic [1:0]              tpl_done_i,
    input  logic [RowW-1:0]         rows_written_i,
    output logic [RowW-1:0]         rows_freed_o,
    output logic                    bank_free_o,
    output logic                    ctx_valid_o,
    input  logic                    ctx_ready_i,
    output slog_pkg::context_t      ctx_o,
    output logic                    row_valid_o,
    input  logic                    row_ready_i,
    output logic [9:0]              row_offsets_o,
    output logic                    step_valid_o,
    output slog_pkg::step_t         step_o,
    output logic [2*GroupBits-1:0]  mask_o,
    output logic                    busy_o
);
  slog_pkg::step_t step;
  always_comb begin
    step_o       = step;
    step_o.valid = 1'b0;
  end
  assign step_valid_o = step.valid;

  slog_sequencer #(
      .GroupBits  (GroupBits),
      .Pitch      (Pitch),
      .RingRows   (RingRows),
      .DrainClocks(DrainClocks)
  ) u_dut (
      .step_o(step),
      .*
  );
endmodule : tb_sequencer
