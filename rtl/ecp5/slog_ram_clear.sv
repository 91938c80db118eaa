// SPDX-License-Identifier: Apache-2.0
// `slog_ram_clear` on the ECP5's block RAMs: the reset of their output registers clears.
//
// Words are laid out as in slog_ram.sv beside this. Latency, throughput, rule: those of ../cells/slog_ram_clear.sv.
`include "slog_assert.svh"
module slog_ram_clear #(
    parameter  int unsigned Width = 8,
    parameter  int unsigned Depth = 16,
    localparam int unsigned AddrW = (Depth > 1) ? $clog2(Depth) : 1
) (
    input  logic             clk_i,
    input  logic             wr_en_i,
    input  logic [AddrW-1:0] wr_addr_i,
    input  logic [Width-1:0] wr_data_i,
    input  logic [AddrW-1:0] rd_addr_i,
    input  logic             clear_i,
    output logic [Width-1:0] rd_data_o
);
  localparam int unsigned Bits   = (Depth <= 512) ? 36 : (Depth <= 1024) ? 18 : 9;
  localparam int unsigned Shift  = (Bits == 36) ? 5 : (Bits == 18) ? 4 : 3;
  localparam int unsigned Blocks = (Width + Bits - 1) / Bits;

  logic [Blocks*Bits-1:0] wr_data, rd_data;

  assign wr_data   = (Blocks * Bits)'(wr_data_i);
  assign rd_data_o = Width'(rd_data);

  for (genvar n = 0; n < Blocks; n++) begin : g_block
    slog_ecp5_bram #(
        .Bits(Bits)
    ) u_block (
        .clk_i,
        .wr_en_i,
        .wr_addr_i(14'(wr_addr_i) << Shift),
        .wr_data_i(wr_data[n*Bits+:Bits]),
        .rd_en_i  (1'b1),
        .clear_i,
        .rd_addr_i(14'(rd_addr_i) << Shift),
        .rd_data_o(rd_data[n*Bits+:Bits])
    );
  end

  `SLOG_ASSERT_INIT(SlogRamClearDepth, Depth <= 2048)
endmodule : slog_ram_clear
