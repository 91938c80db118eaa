// SPDX-License-Identifier: Apache-2.0
// Bit-plane store: Words words of Width bits in block RAM, with a low-priority second read requester.
//
//   stage  registers
//   1      read and write: bank, address, data
//   2      write, one pipeline register more
//   2..8   slog_store_slice, one for each SliceW bits, so that no net is both wide and long; a write one clock later
//   9, 10  rd_data_o, peek_data_o: pipeline registers
// Latency    : rd_valid_i to rd_data_o 10 clocks (slog_store_pkg::StoreLatency); data held until the next read's.
//              A peek takes 11 clocks from peek_valid_i && peek_ready_o to peek_done_o, and waits while rd_valid_i is high.
// Throughput : one read and one write per clock; one peek at a time.
// Rule       : no word is read in the clock after it is written. A read in the same clock gives the old word, a read two
//              clocks later the new one. A peek reads likewise, but may meet the clock after a write to its word: the
//              word is then undefined, and nothing else changes. peek_data_o is valid with peek_done_o.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_store
  import slog_store_pkg::*;
#(
    parameter  int unsigned Width     = 64,
    parameter  int unsigned Words     = 28800,
    parameter  int unsigned BankWords = 16384,
    parameter  int unsigned SliceW    = 8,
    localparam int unsigned AddrW     = $clog2(Words)
) (
    input  logic             clk_i,
    input  logic             rst_i,
    input  logic             wr_valid_i,
    input  logic [AddrW-1:0] wr_addr_i,
    input  logic [Width-1:0] wr_data_i,
    input  logic             rd_valid_i,
    input  logic [AddrW-1:0] rd_addr_i,
    output logic [Width-1:0] rd_data_o,
    input  logic             peek_valid_i,
    output logic             peek_ready_o,
    input  logic [AddrW-1:0] peek_addr_i,
    output logic             peek_done_o,
    output logic [Width-1:0] peek_data_o
);
  localparam int unsigned SliceBits = (SliceW < Width) ? SliceW : Width;
  localparam int unsigned Slices    = Width / SliceBits;
  localparam int unsigned Banks     = bank_count(Words, BankWords);
  localparam int unsigned BankAddrW = (Banks > 1) ? $clog2(BankWords) : AddrW;

  // Peek: a pending address is read in the first clock without rd_valid_i.
  logic peek_pending_q, peek_ready_q;
  logic [AddrW-1:0] peek_addr_q;
  logic [StoreLatency-1:0] peek_at_q;  // [k]: a peek is in stage k + 1
  logic peek_go;
  logic rd_go;
  logic [AddrW-1:0] rd_addr;

  assign peek_ready_o = peek_ready_q;
  assign peek_go      = peek_pending_q && !rd_valid_i;
  assign rd_go        = rd_valid_i || peek_pending_q;
  assign rd_addr      = rd_valid_i ? rd_addr_i : peek_addr_q;
  assign peek_done_o  = peek_at_q[StoreLatency-1];

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      peek_pending_q <= 1'b0;
      peek_ready_q   <= 1'b1;
      peek_at_q      <= '0;
    end else begin
      peek_at_q <= {peek_at_q[StoreLatency-2:0], peek_go};
      peek_pending_q <= peek_ready_q ? peek_valid_i : peek_pending_q && rd_valid_i;
      peek_ready_q   <= peek_ready_q ? !peek_valid_i : peek_at_q[StoreLatency-2];
    end
  end
  always_ff @(posedge clk_i) begin
    if (peek_ready_o) peek_addr_q <= peek_addr_i;
  end

  // The slices lie all over the device: only registers, no logic, lie between here and them.
  logic [Banks-1:0] wr_en, rd_en, wr_en_q, wr_en_q2, rd_en_q;
  logic [BankAddrW-1:0] wr_addr_q, wr_addr_q2, rd_addr_q;
  logic [Width-1:0] wr_data_q, wr_data_q2, data, data_q, data_q2;
  always_ff @(posedge clk_i) begin
    wr_en_q    <= wr_en;
    wr_en_q2   <= wr_en_q;
    wr_addr_q  <= wr_addr_i[BankAddrW-1:0];
    wr_addr_q2 <= wr_addr_q;
    wr_data_q  <= wr_data_i;
    wr_data_q2 <= wr_data_q;
    rd_en_q    <= rd_en;
    rd_addr_q  <= rd_addr[BankAddrW-1:0];
    data_q     <= data;
    data_q2    <= data_q;
  end
  if (Banks > 1) begin : g_bank
    for (genvar b = 0; b < Banks; b++) begin : g_en
      localparam int unsigned Low = bank_bits(bank_depth(Words, BankWords, b), BankWords);
      localparam int unsigned First = bank_start(Words, BankWords, b);
      assign wr_en[b] = wr_valid_i && wr_addr_i[AddrW-1:Low] == First[AddrW-1:Low];
      assign rd_en[b] = rd_go && rd_addr[AddrW-1:Low] == First[AddrW-1:Low];
    end
  end else begin : g_no_bank
    assign wr_en = wr_valid_i;
    assign rd_en = rd_go;
  end

  for (genvar s = 0; s < Slices; s++) begin : g_slice
    slog_store_slice #(
        .Width    (SliceBits),
        .Words    (Words),
        .BankWords(BankWords)
    ) u_slice (
        .clk_i,
        .wr_en_i  (wr_en_q2),
        .wr_addr_i(wr_addr_q2),
        .wr_data_i(wr_data_q2[s*SliceBits+:SliceBits]),
        .rd_en_i  (rd_en_q),
        .rd_addr_i(rd_addr_q),
        .data_o   (data[s*SliceBits+:SliceBits])
    );
  end
  assign rd_data_o   = data_q2;
  assign peek_data_o = data_q2;

  `SLOG_ASSERT(SlogStorePeek, peek_ready_q == !(peek_pending_q || peek_at_q[StoreLatency-2:0] != '0))
  `SLOG_ASSERT_INIT(SlogStoreSlicesFit, Slices * SliceBits == Width)
  `SLOG_ASSERT_INIT(SlogStoreBankPower, Banks == 1 || (BankWords == 2 ** BankAddrW && BankWords >= 4))
  `SLOG_ASSERT_INIT(SlogStoreLatency, StoreLatency == 10)
  `SLOG_ASSERT(SlogStoreAddress, !rd_valid_i || rd_addr_i < AddrW'(Words) || Words == 2 ** AddrW)
  `SLOG_ASSERT(SlogStoreWriteAddress, !wr_valid_i || wr_addr_i < AddrW'(Words) || Words == 2 ** AddrW)
  `SLOG_ASSERT(SlogStorePeekAddress, !peek_pending_q || peek_addr_q < AddrW'(Words) || Words == 2 ** AddrW)
  `SLOG_PAST(past_wr_addr, wr_addr_i)
  `SLOG_ASSERT_NEXT(SlogStoreReadNotWrite, wr_valid_i, !(rd_valid_i && rd_addr_i == past_wr_addr))
endmodule : slog_store
