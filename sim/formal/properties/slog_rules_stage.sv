// SPDX-License-Identifier: Apache-2.0
// slog_stage as a queue of one word.
module slog_rules_stage #(
    parameter int unsigned Width = 4
) (
    input logic             clk_i,
    input logic             rst_i,
    input logic             in_valid_i,
    input logic             in_ready_o,
    input logic [Width-1:0] in_data_i,
    input logic             out_valid_o,
    input logic             out_ready_i,
    input logic [Width-1:0] out_data_o
);
  slog_rules_queue #(.Width(Width), .Depth(1)) u_queue (
      .clk_i, .rst_i, .push(in_valid_i && in_ready_o), .in_data(in_data_i), .offered(out_valid_o),
      .pop(out_valid_o && out_ready_i), .out_data(out_data_o));
  always_ff @(posedge clk_i) begin
    if (!rst_i) begin
      RulesStageOffered : assert (out_valid_o == (u_queue.inside_q != '0));
    end
  end
endmodule : slog_rules_stage

bind slog_stage slog_rules_stage #(.Width(Width)) u_rules (.*);
