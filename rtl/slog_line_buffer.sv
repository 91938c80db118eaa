// Keeps the last 2 * Radius lines and gives with every new pixel the column of 2 * Radius + 1 pixels it ends.
//
// window_o[i] is the pixel 2 * Radius - i lines above the newest; the output row's pixel is window_o[Radius]. Pixels past
// the image's border row are replaced by the one of that row in this column, the edge.
//
// Stages     : 1, 2 line memory read    3 edge: one of four, twice in each bank    4 edge: one of those    5 replace
// Latency    : 5 clocks from valid_i (with px_i, col_i, bottom_i, dist_i) to the window; in other clocks it is anything.
// Throughput : one pixel per clock; a column comes again after 3 clocks at the earliest.
// Formats    : unsigned 8-bit pixels. dist_i: rows from the border row to the output row; Radius = out of reach.
`include "slog_assert.svh"
module slog_line_buffer #(
    parameter  int unsigned MaxWidth = 48,
    parameter  int unsigned Radius   = 8,
    localparam int unsigned Taps     = 2 * Radius + 1,
    localparam int unsigned ColW     = $clog2(MaxWidth),
    localparam int unsigned DistW    = $clog2(Radius + 1)
) (
    input  logic              clk_i,
    input  logic              rst_i,
    input  logic              valid_i,
    input  logic [7:0]        px_i,
    input  logic [ColW-1:0]   col_i,
    input  logic              bottom_i,
    input  logic [DistW-1:0]  dist_i,
    output logic [Taps-1:0][7:0] window_o
);
  localparam int unsigned Banks = Radius / 4;  // 8 lines a bank: 64 bits, one simulator word
  localparam int unsigned PosW  = $clog2(2 * Radius);

  logic [1:0]         valid_q;
  logic [ColW-1:0]    col_q, col_q2;
  logic [7:0]         px_q, px_q2, px_q3;
  logic [PosW-1:0]    pos_q2;
  logic               bottom_q, bottom_q2;
  logic [DistW-1:0]   dist_q;
  logic [1:0]         shift_q2;  // how far beyond_q2 is still to be moved
  logic [Radius-1:0]  beyond_q2, beyond, old_q3, new_q3;
  logic [2*Banks-1:0] four_q3;  // one-hot: the four lines among which the border row is
  logic [64*Banks-1:0]  lines_q3;
  logic [2*Banks-1:0][7:0] edges_q3;
  logic [Taps-1:0][7:0] window_q4, window_q5;
  logic [7:0]           picked, edge_q4;
  logic [Radius-1:0]    old_q4, new_q4;

  always_ff @(posedge clk_i) begin
    if (rst_i) valid_q <= '0;
    else valid_q <= {valid_q[0], valid_i};
  end

  assign beyond = beyond_q2 << shift_q2;

  always_comb begin
    picked = '0;
    for (int unsigned k = 0; k < 2 * Banks; k++) if (four_q3[k]) picked |= edges_q3[k];
  end

  // The border row is never the newest line, so it lies in one of the banks.
  always_ff @(posedge clk_i) begin
    if (valid_i) begin
      col_q    <= col_i;
      px_q     <= px_i;
      bottom_q <= bottom_i;
      dist_q   <= dist_i;
    end
    if (valid_q[0]) begin
      col_q2 <= col_q;
      px_q2  <= px_q;
      pos_q2 <= bottom_q ? PosW'(Radius) + PosW'(dist_q) : PosW'(Radius) - PosW'(dist_q);
      beyond_q2 <= {Radius{1'b1}} << {dist_q[DistW-1:2], 2'b00};
      shift_q2  <= dist_q[1:0];
      bottom_q2 <= bottom_q;
    end
    px_q3     <= px_q2;
    for (int unsigned k = 0; k < 2 * Banks; k++) four_q3[k] <= pos_q2[PosW-1:2] == (PosW-2)'(k);
    old_q3    <= bottom_q2 ? '0 : beyond;
    new_q3    <= bottom_q2 ? beyond : '0;
    window_q4 <= {px_q3, lines_q3};
    edge_q4   <= picked;
    old_q4    <= old_q3;
    new_q4    <= new_q3;
    window_q5 <= window_q4;
    // It follows from the inner ones, and spares the simulator all of them where there is no border.
    if (old_q4 != '0 || new_q4 != '0) begin
      for (int unsigned d = 1; d <= Radius; d++) begin
        if (old_q4[d-1]) window_q5[Radius-d] <= edge_q4;
        if (new_q4[d-1]) window_q5[Radius+d] <= edge_q4;
      end
    end
  end

  for (genvar b = 0; b < Banks; b++) begin : g_bank
    logic [63:0] lines, next_lines;  // byte 0 is the oldest
    logic [7:0]  newer;
    if (b == Banks - 1) begin : g_newest
      assign newer = px_q2;
    end else begin : g_inner
      assign newer = g_bank[b+1].lines[7:0];
    end
    assign next_lines = {newer, lines[63:8]};

    slog_ram #(
        .Width(64),
        .Depth(MaxWidth)
    ) u_lines (
        .clk_i,
        .wr_en_i  (valid_q[1]),
        .wr_addr_i(col_q2),
        .wr_data_i(next_lines),
        .rd_en_i  (valid_i),
        .rd_addr_i(col_i),
        .rd_data_o(lines)
    );

    logic [63:0] bank_lines_q3;
    logic [15:0] bank_edge_q3;
    always_ff @(posedge clk_i) begin
      bank_lines_q3 <= lines;
      bank_edge_q3  <= {lines[{1'b1, pos_q2[1:0], 3'b000}+:8], lines[{1'b0, pos_q2[1:0], 3'b000}+:8]};
    end
    assign lines_q3[64*b+:64] = bank_lines_q3;
    assign edges_q3[2*b+:2] = bank_edge_q3;
  end

  assign window_o = window_q5;

  `SLOG_ASSERT_INIT(SlogLineBufferRadius, Radius >= 8 && (Radius & (Radius - 1)) == 0)
endmodule : slog_line_buffer
