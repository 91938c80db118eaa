// SPDX-License-Identifier: Apache-2.0
// Assumption of slog_video_in's proof: the image size is constant, as slog_filter_bank keeps it while a frame is under way.
module slog_rules_video_in #(
    parameter int unsigned MaxWidth = 8,
    parameter int unsigned Radius   = 2
) (
    input logic       clk_i,
    input logic [9:0] width_i,
    input logic [9:0] height_i,
    input logic       px_valid_o,
    input logic       dropped_o
);
  always_ff @(posedge clk_i) begin
    AssumeSize : assume (32'(width_i) == MaxWidth && 32'(height_i) == 2 * Radius + 2);
    CoverPixel : cover (px_valid_o);
    CoverDropped : cover (dropped_o);
  end
endmodule : slog_rules_video_in

bind slog_video_in slog_rules_video_in #(.MaxWidth(MaxWidth), .Radius(Radius)) u_rules (.*);
