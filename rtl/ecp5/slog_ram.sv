// SPDX-License-Identifier: Apache-2.0
// `slog_ram` on the ECP5's block RAMs with their output registers in use: each block holds some bits of every word.
//
// Each block is configured with the widest words at which one block is deep enough, so no multiplexer follows the output
// registers. The user must split RAMs of more than 16384 words, as slog_store does.
// Latency, throughput, rule: those of ../cells/slog_ram.sv.
`include "slog_assert.svh"
module slog_ram #(
    parameter  int unsigned Width = 8,
    parameter  int unsigned Depth = 16,
    localparam int unsigned AddrW = (Depth > 1) ? $clog2(Depth) : 1
) (
    input  logic             clk_i,
    input  logic             wr_en_i,
    input  logic [AddrW-1:0] wr_addr_i,
    input  logic [Width-1:0] wr_data_i,
    input  logic             rd_en_i,
    input  logic [AddrW-1:0] rd_addr_i,
    output logic [Width-1:0] rd_data_o
);
  localparam int unsigned Bits   = (Depth <= 512) ? 36 : (Depth <= 1024) ? 18 : (Depth <= 2048) ? 9 :
                                   (Depth <= 4096) ? 4 : (Depth <= 8192) ? 2 : 1;
  localparam int unsigned Shift  = (Bits == 36) ? 5 : (Bits == 18) ? 4 : (Bits == 9) ? 3 : (Bits == 4) ? 2 :
                                   (Bits == 2) ? 1 : 0;
  localparam int unsigned Blocks = (Width + Bits - 1) / Bits;

  logic [13:0] wr_addr, rd_addr;
  logic [Blocks*Bits-1:0] wr_data, rd_data;

  assign wr_addr   = 14'(wr_addr_i) << Shift;
  assign rd_addr   = 14'(rd_addr_i) << Shift;
  assign wr_data   = (Blocks * Bits)'(wr_data_i);
  assign rd_data_o = Width'(rd_data);

  for (genvar n = 0; n < Blocks; n++) begin : g_block
    slog_ecp5_bram #(
        .Bits(Bits)
    ) u_block (
        .clk_i,
        .wr_en_i,
        .wr_addr_i(wr_addr),
        .wr_data_i(wr_data[n*Bits+:Bits]),
        .rd_en_i,
        .clear_i  (1'b0),
        .rd_addr_i(rd_addr),
        .rd_data_o(rd_data[n*Bits+:Bits])
    );
  end

  `SLOG_ASSERT_INIT(SlogRamDepth, Depth <= 16384)
endmodule : slog_ram
