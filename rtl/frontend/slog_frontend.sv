// SPDX-License-Identifier: Apache-2.0
// One camera's front end: video in, sign of LoG, words of sign bits out. Wiring only.
//
// Latency    : 38 + Radius + 2 clog2(Radius + 2) + GroupBits clocks from the last pixel of a line, when idle, to the
//              first word of the row Radius lines above it: 128 for full, 62 for tiny.
// Throughput : one pixel per clock, no blanking between lines or frames; words cannot be stalled.
// Abort      : abort_i in clock t drops the frame being received in clock t + 2, in which no pixel is accepted.
// Order      : frame_start_o, GroupBits - 1 clocks later the first word, ..., the last word with frame_done_o; or else
//              frame_abort_o, after which no word of that frame follows. The next frame_start_o is later than either.
// Settings   : width_i, height_i, g_i, g2_i change only in clocks in which busy_o is low and, in the clock before, hold_i
//              or rst_i was high, so that no frame can enter; in the last clock of hold_i the size does not change.
//              busy_o is high from 2 clocks after a frame's first beat to 1 clock after its end, so hold_i must be high
//              for some clocks before a change.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_frontend #(
    parameter int unsigned MaxWidth  = 48,
    parameter int unsigned Radius    = 8,
    parameter int unsigned GroupBits = 8
) (
    input  logic                  clk_i,
    input  logic                  rst_i,
    input  logic [7:0]            tdata_i,
    input  logic                  tvalid_i,
    output logic                  tready_o,
    input  logic                  tuser_i,
    input  logic                  tlast_i,
    input  logic [9:0]            width_i,
    input  logic [9:0]            height_i,
    input  logic [Radius:0][17:0] g_i,
    input  logic [Radius:0][17:0] g2_i,
    input  logic                  hold_i,
    input  logic                  abort_i,  // pulse: drop the frame that is being received, if any
    output logic                  busy_o,
    output logic                  word_valid_o,
    output logic [GroupBits-1:0]  word_data_o,
    output logic                  word_last_o,
    output logic                  frame_start_o,
    output logic                  frame_done_o,
    output logic                  frame_abort_o,
    output logic                  accepted_o,
    output logic                  dropped_o
);
  localparam int unsigned ColW  = $clog2(MaxWidth);
  localparam int unsigned DistW = $clog2(Radius + 1);

  logic             px_valid, px_first, px_last, px_out, px_bottom, px_live, px_start, px_done, px_abort;
  logic [7:0]       px_data;
  logic [ColW-1:0]  px_col;
  logic [DistW-1:0] px_dist;
  logic             bit_valid, bit_sign, bit_last, bit_start, bit_done, bit_abort;
  logic             video_busy, log_busy;

  // The sources of size, hold and abort lie far away.
  logic [9:0] width_q, height_q;
  logic       hold_q, abort_q;
  always_ff @(posedge clk_i) begin
    hold_q   <= hold_i || rst_i;
    abort_q  <= abort_i && !rst_i;
    width_q  <= width_i;
    height_q <= height_i;
  end

  slog_video_in #(
      .MaxWidth(MaxWidth),
      .Radius  (Radius)
  ) u_video_in (
      .clk_i,
      .rst_i,
      .tdata_i,
      .tvalid_i,
      .tready_o,
      .tuser_i,
      .tlast_i,
      .width_i    (width_q),
      .height_i   (height_q),
      .hold_i     (hold_q),
      .abort_i    (abort_q),
      .px_valid_o (px_valid),
      .px_data_o  (px_data),
      .px_col_o   (px_col),
      .px_first_o (px_first),
      .px_last_o  (px_last),
      .px_out_o   (px_out),
      .px_bottom_o(px_bottom),
      .px_dist_o  (px_dist),
      .px_live_o  (px_live),
      .px_start_o (px_start),
      .px_done_o  (px_done),
      .px_abort_o (px_abort),
      .accepted_o,
      .dropped_o,
      .busy_o     (video_busy)
  );

  slog_log #(
      .MaxWidth(MaxWidth),
      .Radius  (Radius)
  ) u_log (
      .clk_i,
      .rst_i,
      .g_i,
      .g2_i,
      .px_valid_i (px_valid),
      .px_data_i  (px_data),
      .px_col_i   (px_col),
      .px_first_i (px_first),
      .px_last_i  (px_last),
      .px_out_i   (px_out),
      .px_bottom_i(px_bottom),
      .px_dist_i  (px_dist),
      .px_live_i  (px_live),
      .px_start_i (px_start),
      .px_done_i  (px_done),
      .px_abort_i (px_abort),
      .bit_valid_o(bit_valid),
      .bit_o      (bit_sign),
      .bit_last_o (bit_last),
      .bit_start_o(bit_start),
      .bit_done_o (bit_done),
      .bit_abort_o(bit_abort),
      .busy_o     (log_busy)
  );

  slog_packer #(
      .GroupBits(GroupBits)
  ) u_packer (
      .clk_i,
      .rst_i,
      .bit_valid_i(bit_valid),
      .bit_i      (bit_sign),
      .bit_last_i (bit_last),
      .bit_start_i(bit_start),
      .bit_done_i (bit_done),
      .bit_abort_i(bit_abort),
      .word_valid_o,
      .word_data_o,
      .word_last_o,
      .frame_start_o,
      .frame_done_o,
      .frame_abort_o
  );

  // Delayed copies fill two gaps: log_busy is asserted only some clocks after a pixel has left the video input, and the
  // packer, which has no busy output, holds a pixel for some clocks after it has left the LoG.
  logic rest_busy_q, busy_q;
  logic [1:0] video_busy_q;
  logic [3:0] log_busy_q;
  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      video_busy_q <= '0;
      log_busy_q   <= '0;
      rest_busy_q  <= 1'b0;
      busy_q       <= 1'b0;
    end else begin
      video_busy_q <= {video_busy_q[0], video_busy};
      log_busy_q   <= {log_busy_q[2:0], log_busy};
      rest_busy_q  <= video_busy_q != '0 || log_busy || log_busy_q != '0;
      busy_q       <= video_busy || video_busy_q != '0 || rest_busy_q;
    end
  end
  assign busy_o = busy_q;

  `SLOG_PAST(past_settings, {width_i, height_i, g_i, g2_i})
  `SLOG_PAST(past_hold, hold_i || rst_i)
  `SLOG_ASSERT(SlogFrontendSettings, {width_i, height_i, g_i, g2_i} == past_settings || (!busy_o && past_hold))
  `SLOG_ASSERT(SlogFrontendDone, !frame_done_o || word_valid_o)
endmodule : slog_frontend
