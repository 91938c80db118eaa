// SPDX-License-Identifier: Apache-2.0
// Holds the last 2 * Radius lines and outputs for every new pixel the column of 2 * Radius + 1 pixels that ends with it.
//
// window_o[i] is the pixel 2 * Radius - i lines above the newest; the output row's pixel is window_o[Radius]. Pixels past
// the image's border row are replaced by that row's pixel in the same column, the border pixel.
//
// Stages     : 1 address    2, 3 line memory    4 lines, written back    5 border pixel in its bank    6 border pixel
//              7 replace
// Latency    : 7 clocks from valid_i (with px_i, col_i, bottom_i, dist_i) to the window, which is undefined in other clocks.
// Throughput : one pixel per clock; the same column is repeated after 4 clocks at the earliest.
// Formats    : unsigned 8-bit pixels. dist_i: rows from the border row to the output row; Radius = out of reach.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_line_buffer #(
    parameter  int unsigned MaxWidth = 48,
    parameter  int unsigned Radius   = 8,
    localparam int unsigned Taps     = 2 * Radius + 1,
    localparam int unsigned ColW     = $clog2(MaxWidth),
    localparam int unsigned DistW    = $clog2(Radius + 1)
) (
    input  logic                 clk_i,
    input  logic                 rst_i,
    input  logic                 valid_i,
    input  logic [7:0]           px_i,
    input  logic [ColW-1:0]      col_i,
    input  logic                 bottom_i,
    input  logic [DistW-1:0]     dist_i,
    output logic [Taps-1:0][7:0] window_o
);
  localparam int unsigned Lines = 2 * Radius;
  localparam int unsigned Banks = Lines / 8;
  localparam int unsigned PosW  = $clog2(Lines);

  logic [2:0]          valid_q;  // [k]: stage k + 1
  logic [ColW-1:0]     col_q, col_q2, col_q3;
  logic [7:0]          px_q, px_q2, px_q3, px_q4, px_q5, px_q6, px_q7;
  logic                bottom_q, bottom_q2, bottom_q3, bottom_q4;
  logic [DistW-1:0]    dist_q, dist_q2, dist_q3;
  logic [PosW-1:0]     pos_q2;       // index of the border row among the lines
  logic                reach_q2;     // the border row is among them
  logic [Lines-1:0]    hot_q3;       // one-hot: the border row
  logic [Radius-1:0]   beyond_q4;    // [d-1]: row d from the output row is past the border; not shifted yet
  logic [1:0]          shift_q4;     // remaining shift of beyond_q4
  logic [Radius-1:0]   beyond, old_q5, new_q5;
  logic [7:0]          border, edge_q6;  // as in the banks, for the newest pixel
  logic                replace_q6;
  logic [Lines-1:0]    replace;
  logic [Banks-1:0][7:0] picked, oldest;

  assign beyond = beyond_q4 << shift_q4;

  always_ff @(posedge clk_i) begin
    if (rst_i) valid_q <= '0;
    else valid_q <= {valid_q[1:0], valid_i};
  end

  // The border row is never the newest line, so it lies in one of the banks.
  always_ff @(posedge clk_i) begin
    {col_q, col_q2, col_q3}          <= {col_i, col_q, col_q2};
    {dist_q, dist_q2, dist_q3}       <= {dist_i, dist_q, dist_q2};
    {bottom_q, bottom_q2, bottom_q3, bottom_q4} <= {bottom_i, bottom_q, bottom_q2, bottom_q3};
    px_q      <= px_i;
    px_q2     <= px_q;
    px_q3     <= px_q2;
    px_q4     <= px_q3;
    px_q5     <= px_q4;
    px_q6     <= px_q5;
    px_q7     <= replace_q6 ? edge_q6 : px_q6;
    pos_q2    <= bottom_q ? PosW'(Radius) + PosW'(dist_q) : PosW'(Radius) - PosW'(dist_q);
    reach_q2  <= dist_q != DistW'(Radius);
    hot_q3    <= reach_q2 ? Lines'(1) << pos_q2 : '0;
    beyond_q4 <= {Radius{1'b1}} << {dist_q3[DistW-1:2], 2'b00};
    shift_q4  <= dist_q3[1:0];
    old_q5    <= bottom_q4 ? '0 : beyond;
    new_q5    <= bottom_q4 ? beyond : '0;
    edge_q6    <= border;
    replace_q6 <= new_q5[Radius-1];
  end

  always_comb begin
    border = '0;
    for (int unsigned b = 0; b < Banks; b++) border |= picked[b];
    replace = '0;
    for (int unsigned d = 1; d <= Radius; d++) begin
      replace[Radius-d] = old_q5[d-1];
      if (d < Radius) replace[Radius+d] = new_q5[d-1];
    end
  end

  for (genvar b = 0; b < Banks; b++) begin : g_bank
    slog_line_bank #(
        .MaxWidth(MaxWidth),
        .Banks   (Banks)
    ) u_bank (
        .clk_i,
        .rst_i,
        .rd_en_i  (valid_i),
        .rd_addr_i(col_i),
        .wr_en_i  (valid_q[2]),
        .wr_addr_i(col_q3),
        .newer_i  (b == Banks - 1 ? px_q4 : oldest[(b+1)%Banks]),
        .hot_i    (hot_q3[8*b+:8]),
        .picked_i (picked),
        .replace_i(replace[8*b+:8]),
        .oldest_o (oldest[b]),
        .picked_o (picked[b]),
        .window_o (window_o[8*b+:8])
    );
  end
  assign window_o[Taps-1] = px_q7;

  `SLOG_ASSERT(SlogLineBufferColumn, !(valid_i && ((valid_q[0] && col_i == col_q) || (valid_q[1] && col_i == col_q2)
                                                   || (valid_q[2] && col_i == col_q3))))
  `SLOG_ASSERT_INIT(SlogLineBufferRadius, Radius >= 8 && (Radius & (Radius - 1)) == 0)
endmodule : slog_line_buffer
