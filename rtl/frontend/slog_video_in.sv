// SPDX-License-Identifier: Apache-2.0
// Receives frames, drops bad ones, and issues whole lines of width_i consecutive clocks to the LoG.
//
// A line is issued when its last pixel has arrived in the right place; only such lines are issued, so all later
// stages process uninterrupted lines. Output row r of a frame is computed while row r + Radius is issued. A frame's
// last Radius rows are computed during the next frame's first lines or, while no frame is received, during filler lines.
//
// No line waits: lines arrive width_i clocks apart or more and are issued in width_i clocks each, and a filler only
// starts while no frame is received, so it ends before the next frame's first line is complete. Two line buffers
// suffice: the line before is read to its end before the first pixel of the line after is written.
//
// Stages     : 1 beat checked    2 line event    3 line started, pixel's address    4 buffers' input    5, 6 buffers
// Latency    : last pixel of a line accepted in clock t: its first pixel is output (px_valid_o) in clock t + 6, if idle.
//              dropped_o follows 2 clocks after the beat that breaks the frame.
// Throughput : one pixel per clock, no blanking. tready_o is low only between frames, in hold_i, and for one clock
//              after abort_i.
// Reset      : rst_i is held for 1 clock or more.
// Frames     : a line that ends early or late, a start of frame before the last line's end, a pixel without start of
//              frame after the last line: the frame is dropped whole, unless its last pixel has been issued already.
//              Then pixels are ignored until the next start of frame. A dropped frame, or a run of stray pixels, is
//              counted once. abort_i drops the frame that is being received as a bad pixel in the next clock would;
//              without such a frame it has no effect.
// Pixels     : without px_valid_o the px_ outputs are undefined, except px_live_o and those listed after it.
// Border     : px_dist_o rows from the border row to the output row: the last row when px_bottom_o, else the first;
//              Radius = border out of reach.
`include "slog_assert.svh"
module slog_video_in #(
    parameter  int unsigned MaxWidth  = 48,
    parameter  int unsigned Radius    = 8,
    localparam int unsigned ColW      = $clog2(MaxWidth),
    localparam int unsigned DistW     = $clog2(Radius + 1)
) (
    input  logic             clk_i,
    input  logic             rst_i,
    input  logic [7:0]       tdata_i,
    input  logic             tvalid_i,
    output logic             tready_o,
    input  logic             tuser_i,
    input  logic             tlast_i,
    input  logic [9:0]       width_i,
    input  logic [9:0]       height_i,
    input  logic             hold_i,
    input  logic             abort_i,      // pulse
    output logic             px_valid_o,   // a pixel of a line, real or filler
    output logic [7:0]       px_data_o,
    output logic [ColW-1:0]  px_col_o,
    output logic             px_first_o,   // first pixel of its line
    output logic             px_last_o,
    output logic             px_out_o,     // an output row is computed during this line
    output logic             px_bottom_o,
    output logic [DistW-1:0] px_dist_o,
    output logic             px_live_o,    // the output pixel belongs to a frame not dropped so far
    output logic             px_start_o,   // first output pixel of a frame
    output logic             px_done_o,    // last output pixel of a frame
    output logic             px_abort_o,   // the frame of the last px_start_o is dropped; in order with the pixels
    output logic             accepted_o,
    output logic             dropped_o,
    output logic             busy_o
);
  localparam int unsigned Depth = 2 * MaxWidth;
  localparam int unsigned AddrW = $clog2(Depth);

  function automatic logic [AddrW-1:0] base(logic line);
    return line ? AddrW'(MaxWidth) : '0;
  endfunction

  logic [9:0] col_last_q, col_second_q, col_third_q, row_last_q;  // last, last but one, last but two column; last row
  always_ff @(posedge clk_i) begin
    col_last_q   <= width_i - 10'd1;
    col_second_q <= width_i - 10'd2;
    col_third_q  <= width_i - 10'd3;
    row_last_q   <= height_i - 10'd1;
  end

  // ---- Receiver: checks every beat. Its events (event_*) reach the scheduler one clock later.
  logic active_q, closed_q;  // in a frame; between frames. If neither, pixels are ignored
  logic outside_q;           // !active_q, a copy: it gates the checks, the original drives tready_o
  logic stop_q;              // no beat is accepted; the frame being received is aborted
  logic at_end_q;            // the next pixel is a line's last, in a frame
  logic last_row_q;          // the line being received is a frame's last
  logic come, beat, good_end, kill, wr_en, active;
  logic event_commit_q, event_kill_q, event_start_q, drop, drop_owed_q, dropped_q;
  logic event_last_q;        // the beat ended a line

  assign tready_o = !stop_q && !(hold_i && !active_q);
  assign come     = tvalid_i && !stop_q;  // a beat, unless hold_i blocks it
  assign beat     = come && !(hold_i && outside_q);
  assign kill     = stop_q ? active_q : tvalid_i && ((active_q && (tuser_i || (tlast_i != at_end_q)))
                                                     || (closed_q && !tuser_i && !hold_i));
  assign good_end = come && at_end_q && !tuser_i && tlast_i;
  assign active   = !stop_q && (tuser_i ? !tlast_i && !(hold_i && outside_q)
                                : active_q && tlast_i == at_end_q && !(at_end_q && last_row_q));
  assign wr_en    = come && (active_q || (tuser_i && !hold_i));
  // A start of frame with tlast is a bad frame by itself, in addition to the frame that it may cut short.
  assign drop     = event_kill_q || (event_start_q && event_last_q);

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      active_q       <= 1'b0;
      outside_q      <= 1'b1;
      closed_q       <= 1'b1;
      stop_q         <= 1'b0;
      event_commit_q <= 1'b0;
      event_kill_q   <= 1'b0;
      event_start_q  <= 1'b0;
      drop_owed_q    <= 1'b0;
      dropped_q      <= 1'b0;
    end else begin
      stop_q <= abort_i;
      if (come || stop_q) begin
        active_q  <= active;
        outside_q <= !active;
      end
      if (beat) closed_q <= !tuser_i && tlast_i && at_end_q && last_row_q;
      event_commit_q <= good_end;
      event_kill_q   <= kill;
      event_start_q  <= beat && tuser_i;
      drop_owed_q    <= (event_kill_q && event_start_q && event_last_q) || (drop && drop_owed_q);
      dropped_q      <= drop || drop_owed_q;
    end
  end
  assign dropped_o = dropped_q;

  // ---- Writer: one clock behind the beats. Its counts are not needed before a line's next to last pixel.
  logic [9:0]       left_q, wr_row_q;  // remaining pixels of the line after the next one
  logic             end_0_q;           // if no pixel is written in this clock, the next is the last but one of its line
  logic             end_1_q;           // if a pixel is written in this clock, the one after it is
  logic             near_end, first_row_q, wr_en_q, wr_en_q2, wr_en_q3;
  logic             wr_line_q;                // buffer of the line being received
  logic [7:0]       wr_data_q, wr_data_q2, wr_data_q3;
  // Addresses are one clock later than the counters: the buffers may lie far away.
  logic             start_q2, jump_q2;       // the pixel starts a frame; the next address is target_q2
  logic [AddrW-1:0] base_q2, target_q2;      // address of the frame's first pixel; address after a jump
  logic [AddrW-1:0] wr_addr_q2, wr_addr_q3;  // address of the pixel unless it starts a frame; address at the buffers

  assign near_end = !event_start_q && (wr_en_q ? end_1_q : end_0_q);

  always_ff @(posedge clk_i) begin
    wr_data_q  <= tdata_i;
    wr_data_q2 <= wr_data_q;
    wr_data_q3 <= wr_data_q2;
    start_q2   <= event_start_q;
    jump_q2    <= event_start_q || event_commit_q;
    base_q2    <= base(wr_line_q);
    target_q2  <= event_start_q ? base(wr_line_q) + 1'b1 : base(!wr_line_q);
    wr_addr_q3 <= start_q2 ? base_q2 : wr_addr_q2;
    if (wr_en_q2) wr_addr_q2 <= jump_q2 ? target_q2 : wr_addr_q2 + 1'b1;
    event_last_q <= tlast_i;
    end_0_q <= !event_start_q && (wr_en_q ? left_q == 10'd2 : left_q == 10'd1);
    end_1_q <= !event_start_q && (wr_en_q ? left_q == 10'd3 : left_q == 10'd2);
    if (wr_en_q) left_q <= event_start_q ? col_second_q : event_commit_q ? col_last_q : left_q - 10'd1;
    if (event_start_q) wr_row_q <= '0;
    else if (event_commit_q) wr_row_q <= wr_row_q + 1'b1;
    last_row_q <= wr_row_q == row_last_q;
    if (event_start_q) first_row_q <= 1'b1;
    else if (event_commit_q) first_row_q <= 1'b0;
    if (rst_i) begin
      at_end_q  <= 1'b0;
      wr_en_q   <= 1'b0;
      wr_en_q2  <= 1'b0;
      wr_en_q3  <= 1'b0;
      wr_line_q <= 1'b0;
    end else begin
      if (come || stop_q) at_end_q <= !stop_q && near_end && active_q && !tuser_i && !tlast_i;
      wr_en_q  <= wr_en;
      wr_en_q2 <= wr_en_q;
      wr_en_q3 <= wr_en_q2;
      if (event_commit_q) wr_line_q <= !wr_line_q;
    end
  end

  // ---- Scheduler: at a line boundary it starts a complete line, or else a filler if a complete frame still has rows left.
  // The current frame is that of the last start of frame.
  logic             line_q, line_first_q;  // a line was completed in the clock before; it is its frame's first
  logic             boundary_q;            // no line is being read, or its last pixel is read
  logic             home_q;                // boundary_q, a copy for the read address, but in a reset
  logic             reading_q;             // a received line, not a filler, is being read
  logic             start_line, skip;
  logic [9:0]       rd_col_q, rd_row_q, out_left_q;
  logic [AddrW-1:0] rd_addr_q;
  logic             rd_line_q;                         // buffer of the line in line_q
  logic             rd_active_q, rd_current_q, rd_current, mid_frame_q, rd_first_q, next_last_q;
  logic             lined_q;                           // a line, real or filler, has begun
  logic             started_q;                         // a received line has begun
  logic             starts_q;                          // a frame's first output row has begun
  logic             head_first_q, head_current_q, head_last_q;
  logic             row_is_last_q, row_is_out_q, out_done_q, out_bottom_q, out_far_q;
  logic             out_active_q, out_current_q, out_active, out_current;
  logic             ended_q;                           // the last pixel of the last output row
  logic [DistW-1:0] out_top_q;
  logic             wait_on, boundary, mid_frame, out_starts, out_kill;

  // The next clock is at a boundary: a line of a dropped frame is skipped, no line can start, or the line ends.
  assign skip         = line_q && event_kill_q;
  // A filler may start if a complete frame has rows left.
  assign wait_on      = boundary_q && !line_q &&
                        (!out_active_q || ended_q || mid_frame_q || active_q || (event_kill_q && out_current_q));
  assign boundary     = skip || wait_on || next_last_q;
  assign start_line   = line_q && !event_kill_q;
  assign out_starts   = start_line && !line_first_q && row_is_out_q;
  assign rd_current   = started_q ? head_current_q : rd_current_q;
  assign out_active   = starts_q || out_active_q;
  assign out_current  = starts_q ? head_current_q : out_current_q;
  assign out_kill     = event_kill_q && out_active && out_current;
  assign mid_frame    = (started_q ? !head_last_q : mid_frame_q) && !(event_kill_q && rd_current);

  // Values that are not needed before the line's end follow its start one clock later.
  always_ff @(posedge clk_i) begin
    rd_line_q      <= wr_line_q;
    line_first_q   <= first_row_q;
    head_first_q   <= line_first_q;
    head_current_q <= line_q && !event_start_q;
    head_last_q    <= !line_first_q && row_is_last_q;
    if (started_q) rd_row_q <= head_first_q ? 10'd1 : rd_row_q + 1'b1;
    row_is_last_q <= rd_row_q == row_last_q;
    row_is_out_q  <= rd_row_q == 10'(Radius);
    if (lined_q) begin
      out_top_q    <= starts_q ? '0 : out_top_q + DistW'(!out_far_q);
      out_left_q   <= starts_q ? row_last_q : out_left_q - 1'b1;
      out_bottom_q <= !starts_q && (out_bottom_q || out_left_q == 10'(Radius));
    end
    out_far_q  <= out_top_q == DistW'(Radius);
    out_done_q <= out_left_q == '0;
  end

  always_ff @(posedge clk_i) begin
    rd_addr_q   <= home_q ? base(rd_line_q) : rd_addr_q + 1'b1;
    rd_col_q    <= home_q ? '0 : rd_col_q + 1'b1;
    rd_first_q  <= boundary_q;
    next_last_q <= rd_col_q == col_third_q;
    if (rst_i) begin
      line_q        <= 1'b0;
      lined_q       <= 1'b0;
      started_q     <= 1'b0;
      starts_q      <= 1'b0;
      boundary_q    <= 1'b1;
      home_q        <= 1'b0;
      reading_q     <= 1'b0;
      rd_active_q   <= 1'b0;
      rd_current_q  <= 1'b0;
      mid_frame_q   <= 1'b0;
      out_active_q  <= 1'b0;
      out_current_q <= 1'b0;
      ended_q       <= 1'b0;
    end else begin
      line_q        <= event_commit_q;
      lined_q       <= boundary_q && !skip && !wait_on;
      started_q     <= start_line;
      starts_q      <= out_starts;
      boundary_q    <= boundary;
      home_q        <= boundary;
      rd_active_q   <= !skip && !wait_on;
      reading_q     <= start_line || (reading_q && !boundary_q);
      mid_frame_q   <= mid_frame;
      rd_current_q  <= rd_current && !event_start_q;
      out_active_q  <= out_active && !out_kill && !ended_q;
      out_current_q <= out_current && !event_start_q;
      ended_q       <= next_last_q && out_done_q;
    end
  end

  // ---- Issue: the line's flags are delayed by the buffers' input register and their two clocks of latency; the border
  // distance joins in the second stage.
  typedef struct packed {
    logic            first;
    logic            last;
    logic            out;
    logic [ColW-1:0] col;
  } issue_t;
  issue_t           issue, issue_q, issue_q2, issue_q3;
  logic             bottom_q2, bottom_q3;
  logic [DistW-1:0] away_q2, away_q3;
  logic             line_out_q, line_out, live, start, done, abort;
  logic [2:0]       valid_q, live_q, out_start_q, done_q, abort_q;  // [k]: k + 1 clocks later
  logic             rd_en_q;      // read enable at the buffers
  logic [AddrW-1:0] rd_addr_q2;
  logic             under_way_q;  // a pixel or an abort is in these stages

  // When a frame is dropped in the middle of a line, the line is still issued to its end: the filters need whole lines.
  assign line_out = rd_first_q ? out_active : line_out_q;
  assign live     = rd_active_q && out_active && !out_kill;
  assign start    = starts_q && !(event_kill_q && head_current_q);
  assign done     = ended_q && out_active_q && !(event_kill_q && out_current_q);
  assign abort    = !starts_q && event_kill_q && out_active_q && out_current_q;

  always_comb begin
    issue.first = rd_first_q;
    issue.last  = boundary_q;
    issue.out   = line_out;
    issue.col   = ColW'(rd_col_q);
  end

  always_ff @(posedge clk_i) begin
    if (rd_active_q) begin
      line_out_q <= line_out;
      issue_q    <= issue;
    end
    issue_q2 <= issue_q;
    issue_q3 <= issue_q2;
    if (valid_q[0]) begin
      bottom_q2 <= out_bottom_q;
      away_q2   <= out_bottom_q ? DistW'(out_left_q) : out_top_q;
    end
    bottom_q3  <= bottom_q2;
    away_q3    <= away_q2;
    rd_en_q    <= reading_q;
    rd_addr_q2 <= rd_addr_q;
    if (rst_i) begin
      valid_q     <= '0;
      live_q      <= '0;
      out_start_q <= '0;
      done_q      <= '0;
      abort_q     <= '0;
      under_way_q <= 1'b0;
    end else begin
      valid_q     <= {valid_q[1:0], rd_active_q};
      live_q      <= {live_q[1:0], live};
      out_start_q <= {out_start_q[1:0], start};
      done_q      <= {done_q[1:0], done};
      abort_q     <= {abort_q[1:0], abort};
      under_way_q <= rd_active_q || abort || valid_q[1:0] != '0 || abort_q[1:0] != '0;
    end
  end

  slog_ram #(
      .Width(8),
      .Depth(Depth)
  ) u_lines (
      .clk_i,
      .wr_en_i  (wr_en_q3),
      .wr_addr_i(wr_addr_q3),
      .wr_data_i(wr_data_q3),
      .rd_en_i  (rd_en_q),
      .rd_addr_i(rd_addr_q2),
      .rd_data_o(px_data_o)
  );

  assign px_valid_o  = valid_q[2];
  assign px_col_o    = issue_q3.col;
  assign px_first_o  = issue_q3.first;
  assign px_last_o   = issue_q3.last;
  assign px_out_o    = issue_q3.out;
  assign px_bottom_o = bottom_q3;
  assign px_dist_o   = away_q3;
  assign px_live_o   = live_q[2];
  assign px_start_o  = out_start_q[2];
  assign px_done_o   = done_q[2];
  assign px_abort_o  = abort_q[2];
  assign accepted_o  = done_q[0];
  assign busy_o      = active_q || event_commit_q || line_q || rd_active_q || out_active_q || under_way_q;

  // The counters that follow one clock later need lines of a minimum length.
  `SLOG_ASSERT_INIT(SlogVideoInRadius, Radius >= 2)
  `SLOG_ASSERT(SlogVideoInNoWait, !line_q || boundary_q)
  `SLOG_ASSERT(SlogVideoInBuffers, !(wr_en_q3 && rd_en_q)
                                   || (32'(wr_addr_q3) < MaxWidth) != (32'(rd_addr_q2) < MaxWidth))
  `SLOG_ASSERT(SlogVideoInBoundary, boundary_q == (!rd_active_q || rd_col_q == col_last_q))
  `SLOG_ASSERT_NEXT(SlogVideoInHome, 1'b1, home_q == boundary_q)
  `SLOG_ASSERT(SlogVideoInAtEnd, !at_end_q || active_q)
  `SLOG_ASSERT(SlogVideoInClosed, !closed_q || !active_q)
  `SLOG_ASSERT(SlogVideoInFlags, start == (live && starts_q) && done == (live && ended_q) &&
                                 abort == (out_kill && !starts_q))
  `SLOG_ASSERT(SlogVideoInUnderWay, under_way_q == (valid_q != '0 || abort_q != '0))
  `SLOG_ASSERT(SlogVideoInCopies, outside_q == !active_q)
  // Right after a reset ended_q may be set, without effect because there is no output frame.
  `SLOG_ASSERT(SlogVideoInEnd, !boundary_q || !out_active_q || ended_q == (rd_active_q && out_done_q))
  `SLOG_ASSERT(SlogVideoInOneOut, !(out_starts && out_active && !ended_q && !out_kill))
  `SLOG_ASSERT(SlogVideoInSize, !wr_en || (32'(width_i) <= MaxWidth && 32'(width_i) >= 2 * Radius + 2
                                           && 32'(height_i) >= 2 * Radius + 2))
endmodule : slog_video_in
