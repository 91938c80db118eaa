// SPDX-License-Identifier: Apache-2.0
// A few bits of every word of the bit-plane store, with its own address registers.
//
//   stage  registers
//   1, 2   address and write data
//   3      address and write data, a copy for each bank
//   4, 5   block RAM and its output register (slog_ram)
//   6      each bank's word
//   7      bank multiplexer
// Latency    : rd_en_i to data_o 7 clocks; data_o is held until the next read's data.
// Throughput : one read and one write per clock.
// Rules      : a word read in the clock in which it is written is undefined (slog_store asserts that only a peek meets
//              this); at most one bank is read and one written.
`include "slog_assert.svh"
module slog_store_slice
  import slog_store_pkg::*;
#(
    parameter  int unsigned Width     = 8,
    parameter  int unsigned Words     = 28800,
    parameter  int unsigned BankWords = 16384,
    localparam int unsigned Banks     = bank_count(Words, BankWords),
    localparam int unsigned AddrW     = (Banks > 1) ? $clog2(BankWords) : $clog2(Words)
) (
    input  logic             clk_i,
    input  logic [Banks-1:0] wr_en_i,
    input  logic [AddrW-1:0] wr_addr_i,
    input  logic [Width-1:0] wr_data_i,
    input  logic [Banks-1:0] rd_en_i,
    input  logic [AddrW-1:0] rd_addr_i,
    output logic [Width-1:0] data_o
);
  logic [AddrW-1:0] rd_addr_q, rd_addr_q2, wr_addr_q, wr_addr_q2;
  logic [Width-1:0] wr_data_q, wr_data_q2, data_q;
  logic [Banks-1:0] wr_en_q, wr_en_q2, wr_en_q3, rd_en_q, rd_en_q2, rd_en_q3, rd_en_q4, rd_en_q5, rd_en_q6;
  logic [Banks-1:0][Width-1:0] bank_data, bank_data_q;
  logic [Width-1:0] chosen;

  always_ff @(posedge clk_i) begin
    wr_en_q    <= wr_en_i;
    wr_en_q2   <= wr_en_q;
    wr_en_q3   <= wr_en_q2;
    wr_addr_q  <= wr_addr_i;
    wr_addr_q2 <= wr_addr_q;
    wr_data_q  <= wr_data_i;
    wr_data_q2 <= wr_data_q;
    rd_en_q    <= rd_en_i;
    rd_en_q2   <= rd_en_q;
    rd_en_q3   <= rd_en_q2;
    rd_en_q4   <= rd_en_q3;
    rd_en_q5   <= rd_en_q4;
    rd_en_q6   <= rd_en_q5;
    rd_addr_q  <= rd_addr_i;
    rd_addr_q2 <= rd_addr_q;
    for (int unsigned b = 0; b < Banks; b++) if (rd_en_q5[b]) bank_data_q[b] <= bank_data[b];
    if (rd_en_q6 != '0) data_q <= chosen;
  end

  for (genvar b = 0; b < Banks; b++) begin : g_bank
    localparam int unsigned Depth = bank_depth(Words, BankWords, b);
    localparam int unsigned DepthW = (Depth > 1) ? $clog2(Depth) : 1;
    logic [DepthW-1:0] rd_addr_q3, wr_addr_q3;
    logic [Width-1:0] wr_data_q3;
    always_ff @(posedge clk_i) begin
      if (rd_en_q2[b]) rd_addr_q3 <= rd_addr_q2[DepthW-1:0];
      if (wr_en_q2[b]) begin
        wr_addr_q3 <= wr_addr_q2[DepthW-1:0];
        wr_data_q3 <= wr_data_q2;
      end
    end
    slog_ram #(
        .Width(Width),
        .Depth(Depth)
    ) u_ram (
        .clk_i,
        .wr_en_i  (wr_en_q3[b]),
        .wr_addr_i(wr_addr_q3),
        .wr_data_i(wr_data_q3),
        .rd_en_i  (rd_en_q3[b]),
        .rd_addr_i(rd_addr_q3),
        .rd_data_o(bank_data[b])
    );
  end

  always_comb begin
    chosen = '0;
    for (int unsigned b = 0; b < Banks; b++) if (rd_en_q6[b]) chosen = bank_data_q[b];
  end
  assign data_o = data_q;

  `SLOG_ASSERT_NO_RESET(SlogStoreSliceOneBank, $onehot0(wr_en_i) && $onehot0(rd_en_i))
endmodule : slog_store_slice
