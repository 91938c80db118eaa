// slog_store as a plain memory: a word that is read or peeked is the one last written to its address.
//
// One address is watched: the proof holds for every choice of it, because choice_q holds anything.
module slog_rules_store
  import slog_store_pkg::*;
#(
    parameter int unsigned Width = 2,
    parameter int unsigned AddrW = 2
) (
    input logic             clk_i,
    input logic             rst_i,
    input logic             wr_valid_i,
    input logic [AddrW-1:0] wr_addr_i,
    input logic [Width-1:0] wr_data_i,
    input logic             rd_valid_i,
    input logic [AddrW-1:0] rd_addr_i,
    input logic [Width-1:0] rd_data_o,
    input logic             peek_valid_i,
    input logic             peek_ready_o,
    input logic [AddrW-1:0] peek_addr_i,
    input logic             peek_done_o,
    input logic [Width-1:0] peek_data_o,
    input logic             peek_go,
    input logic [AddrW-1:0] peek_addr_q
);
  typedef struct packed {
    logic             read;
    logic             peek;
    logic [Width-1:0] word;
  } wanted_t;
  logic [AddrW-1:0] choice_q;
  logic known_q, fresh_q;   // the watched word was written; it was in the clock before, where a peek may give anything
  logic [Width-1:0] word_q;
  wanted_t [StoreLatency-1:0] wanted_q;
  always_ff @(posedge clk_i) begin
    choice_q <= choice_q;
    if (wr_valid_i && wr_addr_i == choice_q) begin
      known_q <= !rst_i;
      word_q  <= wr_data_i;
    end else if (rst_i) begin
      known_q <= 1'b0;
    end
    fresh_q <= wr_valid_i && wr_addr_i == choice_q;
    if (rst_i) begin
      wanted_q <= '0;
    end else begin
      wanted_q <= {wanted_q[StoreLatency-2:0], wanted_t'{read: rd_valid_i && rd_addr_i == choice_q && known_q,
                   peek: peek_go && peek_addr_q == choice_q && known_q && !fresh_q, word: word_q}};
    end
    if (!rst_i) begin
      RulesStoreRead : assert (!wanted_q[StoreLatency-1].read || rd_data_o == wanted_q[StoreLatency-1].word);
      RulesStorePeek : assert (!wanted_q[StoreLatency-1].peek
                               || (peek_done_o && peek_data_o == wanted_q[StoreLatency-1].word));
      CoverRead : cover (wanted_q[StoreLatency-1].read && wanted_q[StoreLatency-1].word != '0);
      CoverPeek : cover (wanted_q[StoreLatency-1].peek && wanted_q[StoreLatency-2].read);
    end
  end
endmodule : slog_rules_store

bind slog_store slog_rules_store #(.Width(Width), .AddrW(AddrW)) u_rules (.*);
