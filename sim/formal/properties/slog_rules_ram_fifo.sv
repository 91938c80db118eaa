// SPDX-License-Identifier: Apache-2.0
// slog_ram_fifo as a queue, and where its words are: output queue, RAM's two read stages, RAM, register before the RAM.
module slog_rules_ram_fifo #(
    parameter int unsigned Width  = 2,
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
    input logic [LevelW-1:0] level_q,
    input logic              push_q,
    input logic              pop_q,
    input logic              read_q,
    input logic              read_q2,
    input logic [AddrW-1:0]  head_q,
    input logic [AddrW-1:0]  tail_q,
    input logic [AddrW-1:0]  after_tail_q,
    input logic [AddrW-1:0]  front_q,
    input logic [AddrW-1:0]  wr_addr_q,
    input logic [AddrW-1:0]  newest_q,
    input logic [Width-1:0]  wr_data_q,
    input logic [2:0]        out_level,
    input logic [2:0]        out_head,
    input logic [Width-1:0]  out_mem[6],
    input logic [Width-1:0]  mem[Depth],
    input logic [Width-1:0]  stage1,
    input logic [Width-1:0]  stage2
);
  slog_rules_queue #(.Width(Width), .Depth(Depth)) u_queue (
      .clk_i, .rst_i, .push, .in_data(in_data_i), .offered(out_valid_o), .pop, .out_data(out_data_o));

  int unsigned ahead, place, stored;
  logic [Width-1:0] word;
  assign stored = 32'(u_queue.inside_q) - 32'(out_level) - 32'(read_q) - 32'(read_q2) - 32'(push_q);
  always_comb begin
    ahead = 32'(u_queue.ahead_q);
    place = 0;
    if (ahead < 32'(out_level)) begin
      word = out_mem[(32'(out_head)+ahead)%6];
    end else begin
      ahead = ahead - 32'(out_level);
      if (read_q2 && ahead == 0) begin
        word = stage2;
      end else if (read_q && ahead == 32'(read_q2)) begin
        word = stage1;
      end else begin
        ahead = ahead - 32'(read_q2) - 32'(read_q);
        place = (32'(head_q) + ahead) % Depth;
        word  = (ahead == stored) ? wr_data_q : mem[place];
      end
    end
  end
  always_ff @(posedge clk_i) begin
    if (!rst_i) begin
      RulesRamFifoLevel : assert (32'(level_q) == 32'(u_queue.inside_q) + 32'(pop_q) && 32'(level_q) <= Depth);
      RulesRamFifoStored : assert (stored <= Depth);
      RulesRamFifoPlaces : assert (32'(head_q) < Depth && 32'(out_head) < 6 && 32'(front_q) < Depth
                                   && (32'(head_q) + stored) % Depth == 32'(wr_addr_q)
                                   && (32'(wr_addr_q) + 32'(push_q)) % Depth == 32'(tail_q)
                                   && (32'(tail_q) + 1) % Depth == 32'(after_tail_q)
                                   && (32'(front_q) + 32'(level_q)) % Depth == 32'(tail_q));
      RulesRamFifoNewest : assert (stored == 0 || (32'(newest_q) + 1) % Depth == 32'(wr_addr_q));
      RulesRamFifoWord : assert (!u_queue.watching_q || word == u_queue.word_q);
      RulesRamFifoOffered : assert (out_valid_o == (out_level != '0));
    end
  end
endmodule : slog_rules_ram_fifo

bind slog_ram_fifo slog_rules_ram_fifo #(.Width(Width), .Depth(Depth), .AddrW(AddrW), .LevelW(LevelW)) u_rules (
    .out_head(u_out.head_q), .out_mem(u_out.mem_q), .mem(u_ram.mem_q), .stage1(u_ram.read_q), .stage2(u_ram.read_q2), .*);
