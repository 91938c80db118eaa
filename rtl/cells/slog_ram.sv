// SPDX-License-Identifier: Apache-2.0
// Simple dual-port block RAM with a registered output: one write and one read port.
//
// Latency    : rd_data_o holds mem[rd_addr_i] two clocks after rd_en_i (array read, output register).
// Throughput : one read and one write per clock.
// Rule       : the data read from an address in the clock in which it is written are undefined and must not be used. Users
//              that enable a read only to use it assert this.
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
  logic [Width-1:0] mem_q[Depth];
  logic [Width-1:0] read_q, read_q2;
  logic fresh_q;

  always_ff @(posedge clk_i) begin
    if (wr_en_i) mem_q[wr_addr_i] <= wr_data_i;
    if (rd_en_i) read_q <= mem_q[rd_addr_i];
    fresh_q <= rd_en_i;
    if (fresh_q) read_q2 <= read_q;
  end
  assign rd_data_o = read_q2;
  `SLOG_ASSERT_INIT(SlogRamDepth, Depth >= 1)
endmodule : slog_ram
