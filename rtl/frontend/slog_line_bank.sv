// SPDX-License-Identifier: Apache-2.0
// Eight of the line buffer's lines, with their own registers for the address and the border pixel.
//
// window_o[k] is the pixel of line k, the oldest first, or, if replace_i[k], the border pixel: that of the line whose hot_i
// bit is set, in this bank or another. With each read the lines move on by one place and newer_i becomes the newest.
//
// Stage  registers          inputs in that stage
//   1    read address       (0) rd_en_i, rd_addr_i
//   2, 3 line memory
//   4    lines, oldest_o    (3) hot_i, wr_en_i, wr_addr_i: written in 4, with (4) newer_i
//   5    picked_o           the border pixel if its line is in this bank, else 0
//   6    border pixel       (5) picked_i of all banks, replace_i
//   7    window_o
// Throughput : one column per clock.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_line_bank #(
    parameter  int unsigned MaxWidth = 48,
    parameter  int unsigned Banks    = 2,
    localparam int unsigned ColW     = $clog2(MaxWidth)
) (
    input  logic                  clk_i,
    input  logic                  rst_i,
    input  logic                  rd_en_i,
    input  logic [ColW-1:0]       rd_addr_i,
    input  logic                  wr_en_i,
    input  logic [ColW-1:0]       wr_addr_i,
    input  logic [7:0]            newer_i,
    input  logic [7:0]            hot_i,
    input  logic [Banks-1:0][7:0] picked_i,
    input  logic [7:0]            replace_i,
    output logic [7:0]            oldest_o,
    output logic [7:0]            picked_o,
    output logic [7:0][7:0]       window_o
);
  logic            rd_en_q, wr_en_q;
  logic [ColW-1:0] rd_addr_q, wr_addr_q;
  logic [7:0]      hot_q4, replace_q6, picked, picked_q5, border, edge_q6;
  logic [7:0][7:0] lines, lines_q4, lines_q5, lines_q6, window_q7;

  slog_ram #(
      .Width(64),  // one simulator word
      .Depth(MaxWidth)
  ) u_lines (
      .clk_i,
      .wr_en_i  (wr_en_q),
      .wr_addr_i(wr_addr_q),
      .wr_data_i({newer_i, lines_q4[7:1]}),
      .rd_en_i  (rd_en_q),
      .rd_addr_i(rd_addr_q),
      .rd_data_o(lines)
  );

  always_comb begin
    picked = '0;
    for (int unsigned k = 0; k < 8; k++) if (hot_q4[k]) picked |= lines_q4[k];
    border = '0;
    for (int unsigned b = 0; b < Banks; b++) border |= picked_i[b];
  end

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      rd_en_q <= 1'b0;
      wr_en_q <= 1'b0;
    end else begin
      rd_en_q <= rd_en_i;
      wr_en_q <= wr_en_i;
    end
    rd_addr_q  <= rd_addr_i;
    wr_addr_q  <= wr_addr_i;
    lines_q4   <= lines;
    hot_q4     <= hot_i;
    lines_q5   <= lines_q4;
    lines_q6   <= lines_q5;
    edge_q6    <= border;
    replace_q6 <= replace_i;
    window_q7  <= lines_q6;
    // Both outer conditions are redundant: they only save simulation time where there is no border.
    picked_q5  <= '0;
    if (hot_q4 != '0) picked_q5 <= picked;
    if (replace_q6 != '0) begin
      for (int unsigned k = 0; k < 8; k++) if (replace_q6[k]) window_q7[k] <= edge_q6;
    end
  end

  assign oldest_o = lines_q4[0];
  assign picked_o = picked_q5;
  assign window_o = window_q7;

  `SLOG_ASSERT(SlogLineBankReadNotWrite, !(wr_en_q && rd_en_q && wr_addr_q == rd_addr_q))
endmodule : slog_line_bank
