// SPDX-License-Identifier: Apache-2.0
// The sums of the row above, for a group of lanes: one block RAM word for each column, all lanes side by side.
//
// Lane k works two columns behind lane k-1, so the lanes' words of one clock share an address: lane k's sum of column x
// is in word x + 2k.
//
// Stage  registers                 valid after the clock of run_i
//   1    rd_addr_q                 1
//   2, 3 slog_ram_clear: above_o   3
//   4    wr_addr                   4: sum_i, which slog_dense_lanes makes of above_o
// Latency    : run_i to above_o 3 clocks; sum_i is taken 4 clocks after run_i.
// Throughput : one word read and one written per clock.
// Rules      : run_i is high from a row's first column to the clock in which the last lane has its last one, for Depth
//              clocks or fewer, and low for one clock at least between rows. In a pass' first row, first_i high with
//              run_i, above_o is 0.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_dense_memory #(
    parameter  int unsigned Width = 88,
    parameter  int unsigned Depth = 656,
    localparam int unsigned AddrW = $clog2(Depth)
) (
    input  logic             clk_i,
    input  logic             rst_i,
    input  logic             run_i,
    input  logic             first_i,
    input  logic [Width-1:0] sum_i,
    output logic [Width-1:0] above_o
);
  logic [3:0] run_q;
  logic [1:0] first_q;
  logic [AddrW-1:0] at_q, rd_addr_q, wr_addr_q;

  always_ff @(posedge clk_i) begin
    if (rst_i) run_q <= '0;
    else run_q <= {run_q[2:0], run_i};
  end
  always_ff @(posedge clk_i) begin
    first_q   <= {first_q[0], first_i};
    at_q      <= run_i ? at_q + 1'b1 : '0;
    rd_addr_q <= at_q;
    wr_addr_q <= run_q[3] ? wr_addr_q + 1'b1 : '0;
  end

  slog_ram_clear #(
      .Width(Width),
      .Depth(Depth)
  ) u_ram (
      .clk_i,
      .wr_en_i  (run_q[3]),
      .wr_addr_i(wr_addr_q),
      .wr_data_i(sum_i),
      .rd_addr_i(rd_addr_q),
      .clear_i  (first_q[1]),
      .rd_data_o(above_o)
  );

`ifndef SYNTHESIS
  logic [AddrW:0] place_q;  // at_q, but where Depth is a power of two it does not start anew after the last word
  always_ff @(posedge clk_i) place_q <= run_i ? place_q + (AddrW + 1)'(!place_q[AddrW]) : '0;
`endif
  `SLOG_ASSERT(SlogDenseMemoryRoom, !run_i || 32'(place_q) < Depth)
  `SLOG_ASSERT(SlogDenseMemoryApart, !(run_q[0] && run_q[3]) || rd_addr_q != wr_addr_q)
endmodule : slog_dense_memory
