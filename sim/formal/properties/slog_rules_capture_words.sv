// SPDX-License-Identifier: Apache-2.0
// slog_capture's way to the store, with channels that may do anything their own proof allows: each camera's words are
// written in the order in which its channel pushes them, none is lost, changed or made up; camera 0 goes first.
module slog_rules_capture_words #(
    parameter int unsigned WordW = 5
) (
    input logic                  clk_i,
    input logic                  rst_i,
    input logic [1:0]            push,
    input logic [1:0]            pop,
    input logic [1:0]            empty,
    input logic [1:0][WordW-1:0] pushed,
    input logic                  wr_valid_o,
    input logic [WordW-1:0]      written
);
  localparam int unsigned Latency = 4;  // clocks from the word's pop to the store's write port
  logic [1:0][2:0] level_q;
  logic [1:0][3:0][WordW-1:0] queue_q;  // [camera][0]: the oldest word
  logic [Latency-1:0] valid_q;
  logic [Latency-1:0][WordW-1:0] word_q;
  for (genvar c = 0; c < 2; c++) begin : g_camera
    always_ff @(posedge clk_i) begin
      if (rst_i) level_q[c] <= '0;
      else level_q[c] <= level_q[c] + 3'(push[c]) - 3'(pop[c]);
      for (int unsigned n = 0; n < 4; n++) begin
        if (pop[c] && n < 3) queue_q[c][n] <= queue_q[c][(n+1)%4];
        if (push[c] && 32'(level_q[c]) == n + 32'(pop[c])) queue_q[c][n] <= pushed[c];
      end
      if (!rst_i) begin
        AssumeRoom : assume (!push[c] || level_q[c] < 3'd4);
        AssumeEmpty : assume (empty[c] == (level_q[c] == '0));
      end
    end
  end
  always_ff @(posedge clk_i) begin
    valid_q <= rst_i ? '0 : {valid_q[Latency-2:0], empty != '1};
    word_q  <= {word_q[Latency-2:0], empty[0] ? queue_q[1][0] : queue_q[0][0]};
    if (!rst_i) begin
      RulesCapturePop : assert (pop == {!empty[1] && empty[0], !empty[0]});
      RulesCaptureWritten : assert (wr_valid_o == valid_q[Latency-1] && (!wr_valid_o || written == word_q[Latency-1]));
      CoverBoth : cover (level_q[0] == 3'd1 && level_q[1] == 3'd4 && wr_valid_o);
      CoverSecondFollows : cover (pop[1] && level_q[1] == 3'd4);
    end
  end
endmodule : slog_rules_capture_words

bind slog_capture slog_rules_capture_words #(.WordW(WordW)) u_rules_words (
    .pushed({g_channel[1].addr, g_channel[1].data, g_channel[0].addr, g_channel[0].data}), .written({wr_addr_o, wr_data_o}),
    .*);
