// SPDX-License-Identifier: Apache-2.0
// slog_fifo as a queue, and where its words are, which makes the proof inductive.
module slog_rules_fifo #(
    parameter int unsigned Width  = 4,
    parameter int unsigned Depth  = 4,
    parameter int unsigned AddrW  = 2,
    parameter int unsigned LevelW = 3
) (
    input logic              clk_i,
    input logic              rst_i,
    input logic              push,
    input logic [Width-1:0]  in_data_i,
    input logic              out_valid_o,
    input logic              pop,
    input logic [Width-1:0]  out_data_o,
    input logic [LevelW-1:0] level_o,
    input logic [AddrW-1:0]  head_q,
    input logic [Width-1:0]  mem_q[Depth]
);
  slog_rules_queue #(.Width(Width), .Depth(Depth)) u_queue (
      .clk_i, .rst_i, .push, .in_data(in_data_i), .offered(out_valid_o), .pop, .out_data(out_data_o));

  logic [AddrW-1:0] place;
  assign place = AddrW'((32'(head_q) + 32'(u_queue.ahead_q)) % Depth);
  always_ff @(posedge clk_i) begin
    if (!rst_i) begin
      RulesFifoLevel : assert (level_o == u_queue.inside_q);
      RulesFifoHead : assert (32'(head_q) < Depth);
      RulesFifoWord : assert (!u_queue.watching_q || mem_q[place] == u_queue.word_q);
      RulesFifoOffered : assert (out_valid_o == (u_queue.inside_q != '0));
    end
  end
endmodule : slog_rules_fifo

bind slog_fifo slog_rules_fifo #(.Width(Width), .Depth(Depth), .AddrW(AddrW), .LevelW(LevelW)) u_rules (.*);
