// SPDX-License-Identifier: Apache-2.0
// One register between two handshakes: cuts the timing path from a queue's memory to its user.
//
// Latency    : a word accepted in clock t is offered in clock t+1.
// Throughput : one word per clock; in_ready_o depends on out_ready_i in the same clock. With Half, one word in two clocks,
//              and in_ready_o depends on a register alone.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_stage #(
    parameter int unsigned Width = 8,
    parameter bit          Half  = 1'b0
) (
    input  logic             clk_i,
    input  logic             rst_i,
    input  logic             in_valid_i,
    output logic             in_ready_o,
    input  logic [Width-1:0] in_data_i,
    output logic             out_valid_o,
    input  logic             out_ready_i,
    output logic [Width-1:0] out_data_o
);
  logic valid_q, valid;
  logic free_q;  // a separate copy of !valid_q, because it enables all bits of data_q
  logic [Width-1:0] data_q;

  assign in_ready_o  = !valid_q || (out_ready_i && !Half);
  assign valid       = in_ready_o ? in_valid_i : valid_q && !out_ready_i;
  assign out_valid_o = valid_q;
  assign out_data_o  = data_q;

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      valid_q <= 1'b0;
      free_q  <= 1'b1;
    end else begin
      valid_q <= valid;
      free_q  <= !valid;
    end
  end

  always_ff @(posedge clk_i) begin
    if (free_q || (out_ready_i && !Half)) data_q <= in_data_i;
  end

  `SLOG_ASSERT(SlogStageCopies, free_q == !valid_q)
  `SLOG_ASSERT_STABLE(SlogStageOutStable, out_valid_o, out_ready_i, out_data_o)
endmodule : slog_stage
