// SPDX-License-Identifier: Apache-2.0
// Sign of the Laplacian of Gaussian of a raster of whole lines: wiring of the line buffer, the filters and the window.
//
// v = (g * p + 64) >> 7, v2 = (g2 * p + 64) >> 7 down the columns; bit = g2 * v + g * v2 > 0 along the rows. Past the
// image the border pixels are repeated. g sums to 2**15, g2 to 0, its positive taps to at most 2**15.
//
// Stages     : input 1, line buffer 7, vertical FIR 7 + L, window Radius + 2, horizontal FIR 8 + L, sum 2, by halves;
//              L = clog2(Radius + 2)
// Latency    : 27 + Radius + 2 L clocks from px_valid_i to bit_valid_o: 53 at radius 16, 43 at radius 8.
//              busy_o is high from 3 clocks after a pixel or an abort enters to 1 clock after it leaves.
// Throughput : one pixel per clock, whole lines in consecutive clocks. px_live_i only under an output row.
// Formats    : pixels unsigned 8 bits; v, v2 17 bits signed; response 36 bits signed, of which only "> 0" is output.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_log #(
    parameter  int unsigned MaxWidth = 48,
    parameter  int unsigned Radius   = 8,
    localparam int unsigned ColW     = $clog2(MaxWidth),
    localparam int unsigned DistW    = $clog2(Radius + 1),
    localparam int unsigned Levels   = $clog2(Radius + 2),
    localparam int unsigned Latency  = 27 + Radius + 2 * Levels
) (
    input  logic                  clk_i,
    input  logic                  rst_i,
    input  logic [Radius:0][17:0] g_i,
    input  logic [Radius:0][17:0] g2_i,
    input  logic                  px_valid_i,
    input  logic [7:0]            px_data_i,
    input  logic [ColW-1:0]       px_col_i,
    input  logic                  px_first_i,
    input  logic                  px_last_i,
    input  logic                  px_out_i,
    input  logic                  px_bottom_i,
    input  logic [DistW-1:0]      px_dist_i,
    input  logic                  px_live_i,
    input  logic                  px_start_i,
    input  logic                  px_done_i,
    input  logic                  px_abort_i,
    output logic                  bit_valid_o,
    output logic                  bit_o,
    output logic                  bit_last_o,   // last of its row
    output logic                  bit_start_o,  // first of its frame
    output logic                  bit_done_o,   // last of its frame
    output logic                  bit_abort_o,
    output logic                  busy_o
);
  localparam int unsigned FirLatency = 7 + Levels;
  localparam int unsigned ToVertical = 8;
  localparam int unsigned ToTaps     = ToVertical + FirLatency;
  localparam int unsigned SumV       = 24;  // wide enough for the sums; single products may wrap
  localparam int unsigned SumH       = 36;
  localparam int unsigned LowH       = SumH / 2;
  localparam int unsigned LeftW      = $clog2(Latency + 1);

  // The source of the pixels lies far away.
  logic             px_valid_q, px_first_q, px_last_q, px_out_q, px_bottom_q;
  logic [7:0]       px_data_q;
  logic [ColW-1:0]  px_col_q;
  logic [DistW-1:0] px_dist_q;
  always_ff @(posedge clk_i) begin
    px_valid_q  <= px_valid_i && !rst_i;
    px_data_q   <= px_data_i;
    px_col_q    <= px_col_i;
    px_first_q  <= px_first_i;
    px_last_q   <= px_last_i;
    px_out_q    <= px_out_i;
    px_bottom_q <= px_bottom_i;
    px_dist_q   <= px_dist_i;
  end

  // Flags that accompany the pixels of an output row. [k]: k + 1 clocks after px_*.
  logic [ToTaps-1:1]  out_q, first_q;
  logic [Latency-1:1] last_q;
  logic [Latency-1:0] live_q, start_q, done_q, abort_q;
  logic [LeftW-1:0]   left_q;  // clocks until the last one that entered has left
  logic               out, come_q, busy_q;

  assign out = px_valid_q && px_out_q;

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      out_q   <= '0;
      first_q <= '0;
      last_q  <= '0;
      live_q  <= '0;
      start_q <= '0;
      done_q  <= '0;
      abort_q <= '0;
      left_q  <= '0;
      come_q  <= 1'b0;
      busy_q  <= 1'b0;
    end else begin
      out_q   <= {out_q[ToTaps-2:1], out};
      first_q <= {first_q[ToTaps-2:1], out && px_first_q};
      last_q  <= {last_q[Latency-2:1], out && px_last_q};
      live_q  <= {live_q[Latency-2:0], px_live_i};
      start_q <= {start_q[Latency-2:0], px_start_i};
      done_q  <= {done_q[Latency-2:0], px_done_i};
      abort_q <= {abort_q[Latency-2:0], px_abort_i};
      come_q  <= out || live_q[0] || abort_q[0];
      busy_q  <= come_q || left_q != '0;
      if (come_q) left_q <= LeftW'(Latency - 2);
      else if (left_q != '0) left_q <= left_q - 1'b1;
    end
  end

  logic [2*Radius:0][7:0] column;
  slog_line_buffer #(
      .MaxWidth(MaxWidth),
      .Radius  (Radius)
  ) u_lines (
      .clk_i,
      .rst_i,
      .valid_i (px_valid_q),
      .px_i    (px_data_q),
      .col_i   (px_col_q),
      .bottom_i(px_bottom_q),
      .dist_i  (px_dist_q),
      .window_o(column)
  );

  logic [1:0][SumV-1:0] vertical;
  logic [17:0]          smoothed, curved;  // v, v2, extended by one bit for the sums of pairs
  slog_fir #(
      .Radius (Radius),
      .DataW  (8),
      .Kernels(2),
      .SumW   (SumV),
      .Bias   (64)
  ) u_vertical (
      .clk_i,
      .rst_i,
      .valid_i (out_q[ToVertical-1]),
      .window_i(column),
      .coef_i  ({g2_i, g_i}),
      .sum_o   (vertical)
  );
  assign smoothed = {vertical[0][23], vertical[0][7+:17]};
  assign curved   = {vertical[1][23], vertical[1][7+:17]};

  logic                    row_valid;
  logic [2*Radius:0][31:0] smoothed_row, curved_row;
  slog_taps #(
      .Radius(Radius),
      .DataW (18)
  ) u_taps (
      .clk_i,
      .rst_i,
      .valid_i   (out_q[ToTaps-1]),
      .first_i   (first_q[ToTaps-1]),
      .last_i    (last_q[ToTaps-1]),
      .a_i       (smoothed),
      .b_i       (curved),
      .valid_o   (row_valid),
      .a_window_o(smoothed_row),
      .b_window_o(curved_row)
  );

  // The bias -1 turns "sum > 0" into "sum - 1 >= 0", which is the sum's sign bit.
  logic [SumH-1:0] term_a, term_b;
  slog_fir #(
      .Radius (Radius),
      .DataW  (32),
      .Kernels(1),
      .SumW   (SumH),
      .Bias   (-1)
  ) u_smoothed (
      .clk_i,
      .rst_i,
      .valid_i (row_valid),
      .window_i(smoothed_row),
      .coef_i  (g2_i),
      .sum_o   (term_a)
  );
  slog_fir #(
      .Radius (Radius),
      .DataW  (32),
      .Kernels(1),
      .SumW   (SumH),
      .Bias   (0)
  ) u_curved (
      .clk_i,
      .rst_i,
      .valid_i (row_valid),
      .window_i(curved_row),
      .coef_i  (g_i),
      .sum_o   (term_b)
  );

  // Of the lower half's sum only the carry matters, of the upper half's the sign.
  logic              dark_q;  // not > 0
  logic              carry_q;
  logic [LowH-1:0]   upper_a_q, upper_b_q;
  /* verilator lint_off UNUSEDSIGNAL */
  logic [LowH:0]     lower;
  logic [LowH:0]     upper;
  /* verilator lint_on UNUSEDSIGNAL */
  assign lower = {1'b0, term_a[LowH-1:0]} + {1'b0, term_b[LowH-1:0]};
  assign upper = {upper_a_q, 1'b1} + {upper_b_q, carry_q};
  always_ff @(posedge clk_i) begin
    carry_q   <= lower[LowH];
    upper_a_q <= term_a[SumH-1:LowH];
    upper_b_q <= term_b[SumH-1:LowH];
    dark_q    <= upper[LowH];
  end

  assign bit_o       = !dark_q;
  assign bit_valid_o = live_q[Latency-1];
  assign bit_last_o  = last_q[Latency-1];
  assign bit_start_o = start_q[Latency-1];
  assign bit_done_o  = done_q[Latency-1];
  assign bit_abort_o = abort_q[Latency-1];
  assign busy_o      = busy_q;

  `SLOG_ASSERT_INIT(SlogLogHalves, SumV <= 24 && SumH > 24)
  `SLOG_ASSERT_NEXT(SlogLogWholeLines, px_valid_i && !px_last_i, px_valid_i)
  `SLOG_ASSERT(SlogLogLineLength, !(px_valid_i && px_last_i) || 32'(px_col_i) >= 2 * Radius + 1)
  `SLOG_ASSERT(SlogLogLiveOut, !px_live_i || (px_valid_i && px_out_i))
  `SLOG_ASSERT(SlogLogDistance, !(px_valid_i && px_out_i) || px_dist_i <= DistW'(Radius))
endmodule : slog_log
