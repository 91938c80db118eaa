// SPDX-License-Identifier: Apache-2.0
// Simple dual-port block RAM, read in every clock, whose output register can be cleared: one write and one read port.
//
// Latency    : rd_data_o holds mem[rd_addr_i] two clocks after the address (array read, output register), or 0 where
//              clear_i is high in the clock after the address.
// Throughput : one read and one write per clock.
// Rule       : the data read from an address in the clock in which it is written are undefined and must not be used.
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
  logic [Width-1:0] mem_q[Depth];
  logic [Width-1:0] read_q, read_q2;

  always_ff @(posedge clk_i) begin
    if (wr_en_i) mem_q[wr_addr_i] <= wr_data_i;
    read_q  <= mem_q[rd_addr_i];
    read_q2 <= clear_i ? '0 : read_q;
  end
  assign rd_data_o = read_q2;
  `SLOG_ASSERT_INIT(SlogRamClearDepth, Depth >= 1)
endmodule : slog_ram_clear
