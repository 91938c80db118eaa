// SPDX-License-Identifier: Apache-2.0
// slog_store, of one slice and three banks, as a plain memory: a word that is read or peeked is the one last written to its
// address; and no block RAM is read for the read port at the address that is written in the same clock.
//
// One address is watched: the proof holds for every choice of it.
module slog_rules_store
  import slog_store_pkg::*;
#(
    parameter int unsigned Width     = 1,
    parameter int unsigned AddrW     = 3,
    parameter int unsigned Words     = 7,
    parameter int unsigned BankWords = 4
) (
    input logic             clk_i,
    input logic             rst_i,
    input logic             wr_valid_i,
    input logic [AddrW-1:0] wr_addr_i,
    input logic [Width-1:0] wr_data_i,
    input logic             rd_valid_i,
    input logic [AddrW-1:0] rd_addr_i,
    input logic [Width-1:0] rd_data_o,
    input logic             peek_done_o,
    input logic [Width-1:0] peek_data_o,
    input logic             peek_go,
    input logic [AddrW-1:0] peek_addr_q,
    // The banks' block RAMs.
    input logic [2:0]       ram_wr,
    input logic [2:0]       ram_rd,
    input logic [2:0]       ram_same,   // the same address is read and written
    input logic [Width-1:0] whole[BankWords],
    input logic [Width-1:0] half[BankWords/2],
    input logic [Width-1:0] rest[Words-BankWords/2*3]
);
  localparam int unsigned WriteClocks = 6;  // from wr_valid_i to the word in its block RAM
  localparam int unsigned ReadClocks = 4;   // from rd_valid_i to the block RAM's read
  typedef struct packed {
    logic             read;
    logic             peek;
    logic [Width-1:0] word;
  } wanted_t;
  logic [AddrW-1:0] choice;
  slog_rules_choice #(.Width(AddrW)) u_choice (.clk_i, .choice);
  logic [WriteClocks-1:0] known_q = '0;          // [k]: the watched word had been written k + 1 clocks ago
  logic [WriteClocks-1:0][Width-1:0] word_q;     // [k]: its value then
  logic fresh_q, was_reset_q;                    // it was written in the clock before
  logic [ReadClocks-1:0] read_q = '0;            // [k]: a word was read k + 1 clocks ago
  wanted_t [StoreLatency-1:0] wanted_q = '0;
  logic written, read, peek;
  logic [Width-1:0] stored;
  assign written = wr_valid_i && wr_addr_i == choice;
  assign read    = rd_valid_i && !rst_i && !was_reset_q;
  assign peek    = peek_go && !rst_i && !fresh_q;
  localparam int unsigned RestStart = BankWords / 2 * 3;
  assign stored  = (32'(choice) < BankWords) ? whole[32'(choice)%BankWords] :
                   (32'(choice) < RestStart) ? half[32'(choice)%(BankWords/2)] : rest[32'(choice)%(Words-RestStart)];
  always_ff @(posedge clk_i) begin
    was_reset_q <= rst_i;
    fresh_q     <= written;
    known_q     <= {known_q[WriteClocks-2:0], known_q[0] || written};
    word_q      <= {word_q[WriteClocks-2:0], written ? wr_data_i : word_q[0]};
    read_q      <= {read_q[ReadClocks-2:0], read};
    wanted_q    <= {wanted_q[StoreLatency-2:0], wanted_t'{read: read && rd_addr_i == choice && known_q[0],
                    peek: peek && peek_addr_q == choice && known_q[0], word: word_q[0]}};
    if (rst_i) wanted_q <= '0;
    AssumeInStore : assume (!wr_valid_i || 32'(wr_addr_i) < Words);  // in reset too
    AssumeChoice : assume (32'(choice) < Words);
    RulesStoreWord : assert (!known_q[WriteClocks-1] || stored == word_q[WriteClocks-1]);  // in reset too
    if (!rst_i) begin
      RulesStoreRead : assert (!wanted_q[StoreLatency-1].read || rd_data_o == wanted_q[StoreLatency-1].word);
      RulesStorePeek : assert (!wanted_q[StoreLatency-1].peek
                               || (peek_done_o && peek_data_o == wanted_q[StoreLatency-1].word));
      RulesStoreNotWritten : assert (!read_q[ReadClocks-1] || (ram_wr & ram_rd & ram_same) == '0);
      CoverRead : cover (wanted_q[StoreLatency-1].read && wanted_q[StoreLatency-1].word != '0 && 32'(choice) >= RestStart);
      CoverPeek : cover (wanted_q[StoreLatency-1].peek && wanted_q[StoreLatency-2].read);
      CoverPeekMeetsWrite : cover ((ram_wr & ram_rd & ram_same) != '0);
    end
  end
endmodule : slog_rules_store

bind slog_store slog_rules_store #(.Width(Width), .AddrW(AddrW), .Words(Words), .BankWords(BankWords)) u_rules (
    .ram_wr({g_slice[0].u_slice.g_bank[2].u_ram.wr_en_i, g_slice[0].u_slice.g_bank[1].u_ram.wr_en_i,
             g_slice[0].u_slice.g_bank[0].u_ram.wr_en_i}),
    .ram_rd({g_slice[0].u_slice.g_bank[2].u_ram.rd_en_i, g_slice[0].u_slice.g_bank[1].u_ram.rd_en_i,
             g_slice[0].u_slice.g_bank[0].u_ram.rd_en_i}),
    .ram_same({g_slice[0].u_slice.g_bank[2].u_ram.wr_addr_i == g_slice[0].u_slice.g_bank[2].u_ram.rd_addr_i,
               g_slice[0].u_slice.g_bank[1].u_ram.wr_addr_i == g_slice[0].u_slice.g_bank[1].u_ram.rd_addr_i,
               g_slice[0].u_slice.g_bank[0].u_ram.wr_addr_i == g_slice[0].u_slice.g_bank[0].u_ram.rd_addr_i}),
    .whole(g_slice[0].u_slice.g_bank[0].u_ram.mem_q), .half(g_slice[0].u_slice.g_bank[1].u_ram.mem_q),
    .rest(g_slice[0].u_slice.g_bank[2].u_ram.mem_q), .*);
