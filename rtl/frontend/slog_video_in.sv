// Receives frames, drops bad ones, and issues whole lines of width_i consecutive clocks to the LoG.
//
// A line enters the ring when its last pixel arrives in the right place; only such lines are issued, so all later
// stages process uninterrupted lines. Output row r of a frame is computed while row r + Radius is issued. A frame's
// last Radius rows are computed during the next frame's first lines or, while no frame is received, during filler lines.
//
// Stages     : 1 beat checked    2 line event    3 line started, pixel's address    4 ring's input    5, 6 ring
// Latency    : last pixel of a line accepted in clock t: its first pixel is output (px_valid_o) in clock t + 6, if idle.
//              dropped_o follows 2 clocks after the beat that breaks the frame.
// Throughput : one pixel per clock, no blanking. tready_o is low only while the ring is full or,
//              between frames, in hold_i.
// Frames     : a line that ends early or late, a start of frame before the last line's end, a pixel without start of
//              frame after the last line: the frame is dropped whole, unless its last pixel has been issued already.
//              Then pixels are ignored until the next start of frame. A dropped frame, or a run of stray pixels, is
//              counted once.
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
  localparam int unsigned Lines = 3;  // one being written, one being read, one for the clocks in which both change lines
  localparam int unsigned Depth = Lines * MaxWidth;
  localparam int unsigned AddrW = $clog2(Depth);

  function automatic logic [1:0] next_line(logic [1:0] line);
    return (line == 2'(Lines - 1)) ? '0 : line + 1'b1;
  endfunction

  function automatic logic [AddrW-1:0] base(logic [1:0] line);
    unique case (line)
      2'd0:    return '0;
      2'd1:    return AddrW'(MaxWidth);
      default: return AddrW'(2 * MaxWidth);
    endcase
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
  logic full_q;              // the ring has no room
  logic outside_q, room_q;   // inverted copies: they gate the checks, the originals drive tready_o
  logic at_end_q;            // the next pixel is a line's last, in a frame
  logic last_row_q;          // the line being received is a frame's last
  logic come, beat, good_end, kill, wr_en, active;
  logic event_commit_q, event_kill_q, event_start_q, drop, drop_owed_q, dropped_q;
  logic event_last_q;        // the beat ended a line

  assign tready_o = !full_q && !(hold_i && !active_q);
  assign come     = tvalid_i && room_q;  // a beat, unless hold_i blocks it
  assign beat     = tvalid_i && !full_q && !(hold_i && outside_q);
  assign kill     = come && ((active_q && (tuser_i || (tlast_i != at_end_q))) || (closed_q && !tuser_i && !hold_i));
  assign good_end = come && at_end_q && !tuser_i && tlast_i;
  assign active   = tuser_i ? !tlast_i && !(hold_i && outside_q)
                    : active_q && tlast_i == at_end_q && !(at_end_q && last_row_q);
  assign wr_en    = come && (active_q || (tuser_i && !hold_i));
  // A start of frame with tlast is a bad frame by itself, in addition to the frame that it may cut short.
  assign drop     = event_kill_q || (event_start_q && event_last_q);

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      active_q       <= 1'b0;
      outside_q      <= 1'b1;
      closed_q       <= 1'b1;
      event_commit_q <= 1'b0;
      event_kill_q   <= 1'b0;
      event_start_q  <= 1'b0;
      drop_owed_q    <= 1'b0;
      dropped_q      <= 1'b0;
    end else begin
      if (come) begin
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
  logic             end_0_q, end_1_q;  // the next pixel is the last but one: if none, if one is written in this clock
  logic             near_end, first_row_q, wr_en_q, wr_en_q2, wr_en_q3;
  logic [1:0]       wr_line_q;
  logic [7:0]       wr_data_q, wr_data_q2, wr_data_q3;
  // Addresses are one clock later than the counters: the ring may lie far away.
  logic             start_q2, jump_q2;       // the pixel starts a frame; the next address is target_q2, not this one + 1
  logic [AddrW-1:0] base_q2, target_q2;      // address of the frame's first pixel; address after a jump
  logic [AddrW-1:0] wr_addr_q2, wr_addr_q3;  // address of the pixel unless it starts a frame; address at the ring

  assign near_end = !event_start_q && (wr_en_q ? end_1_q : end_0_q);

  always_ff @(posedge clk_i) begin
    wr_data_q  <= tdata_i;
    wr_data_q2 <= wr_data_q;
    wr_data_q3 <= wr_data_q2;
    start_q2   <= event_start_q;
    jump_q2    <= event_start_q || event_commit_q;
    base_q2    <= base(wr_line_q);
    target_q2  <= event_start_q ? base(wr_line_q) + 1'b1 : base(next_line(wr_line_q));
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
      wr_line_q <= '0;
    end else begin
      if (come) at_end_q <= near_end && active_q && !tuser_i && !tlast_i;
      wr_en_q  <= wr_en;
      wr_en_q2 <= wr_en_q;
      wr_en_q3 <= wr_en_q2;
      if (event_commit_q) wr_line_q <= next_line(wr_line_q);
    end
  end

  // ---- Ring: state of each committed line, the oldest first. The current frame is that of the last start of frame.
  typedef struct packed {
    logic valid;
    logic current;  // valid, of the current frame
    logic dead;     // valid, of a dropped frame
    logic live;     // valid and not dead
    logic first;    // the first line of its frame
  } line_t;
  line_t [Lines-1:0] line_q, line_d;
  logic              head_current, head_dead;  // state of the oldest line, with this clock's events
  logic              boundary_q;    // no line is being read, or its last pixel is read
  logic              along_q;       // !boundary_q
  logic              reading_q;     // a line of the ring, not a filler, is being read
  logic              start_line, skip, two, full;

  always_comb begin
    for (int unsigned n = 0; n < Lines; n++) begin
      line_t kept;
      logic ahead;  // the place ahead holds a line
      kept  = !boundary_q ? line_q[n] : (n + 1 < Lines) ? line_q[(n + 1) % Lines] : '0;
      ahead = n == 0 || (boundary_q ? line_q[n].valid : line_q[(n + Lines - 1) % Lines].valid);
      line_d[n].valid   = kept.valid || (event_commit_q && ahead);
      line_d[n].current = kept.valid ? kept.current && !event_start_q : event_commit_q && ahead;
      line_d[n].dead    = kept.dead || (event_kill_q && kept.current);
      line_d[n].live    = kept.valid ? kept.live && !(event_kill_q && kept.current) : event_commit_q && ahead;
      line_d[n].first   = kept.valid ? kept.first : first_row_q;
    end
    // The ring holds two lines, counting the one being read and the one committed now.
    two          = reading_q && event_commit_q ? !line_q[0].valid
                   : reading_q || event_commit_q ? line_q[0].valid && !line_q[1].valid
                   : line_q[1].valid && !line_q[2].valid;
    head_current = line_q[0].current && !event_start_q;
    head_dead    = line_q[0].dead || (event_kill_q && line_q[0].current);
    full         = !(reading_q && boundary_q) && !skip && (full_q || (good_end && two));
  end

  always_ff @(posedge clk_i) begin
    line_q <= line_d;
    if (rst_i) begin
      full_q <= 1'b0;
      room_q <= 1'b1;
      for (int unsigned n = 0; n < Lines; n++) begin
        {line_q[n].valid, line_q[n].current, line_q[n].dead, line_q[n].live} <= '0;
      end
    end else begin
      full_q <= full;
      room_q <= !full;
    end
  end

  // ---- Scheduler: at a line boundary it starts a committed line, or else a filler if a complete frame still has rows left.
  logic [9:0]       rd_col_q, rd_row_q, out_left_q;
  logic [AddrW-1:0] rd_addr_q;
  logic [1:0]       rd_line_q;
  logic             rd_active_q, rd_current_q, rd_current, mid_frame_q, rd_first_q, next_last_q;
  logic             lined_q, started_q, starts_q;      // began: a line, a line of the ring, a frame's first output row
  logic             head_first_q, head_current_q, head_last_q;
  logic             row_is_last_q, row_is_out_q, out_done_q, out_bottom_q, out_far_q;
  logic             out_active_q, out_current_q, out_active, out_current;
  logic             ended_q;                           // the last pixel of the last output row
  logic [DistW-1:0] out_top_q;
  logic             wait_on, boundary, mid_frame, out_starts, out_kill;

  // The next clock is at a boundary: a dead line is skipped, no line can start, or the line ends.
  assign skip         = boundary_q && head_dead;
  // A filler may start if a complete frame has rows left.
  assign wait_on      = boundary_q && !line_q[0].valid &&
                        (!out_active_q || ended_q || mid_frame_q || active_q || (event_kill_q && out_current_q));
  assign boundary     = skip || wait_on || next_last_q;
  assign start_line   = boundary_q && line_q[0].live && !(event_kill_q && line_q[0].current);
  assign out_starts   = start_line && !line_q[0].first && row_is_out_q;
  assign rd_current   = started_q ? head_current_q : rd_current_q;
  assign out_active   = starts_q || out_active_q;
  assign out_current  = starts_q ? head_current_q : out_current_q;
  assign out_kill     = event_kill_q && out_active && out_current;
  assign mid_frame    = (started_q ? !head_last_q : mid_frame_q) && !(event_kill_q && rd_current);

  // Values that are not needed before the line's end follow its start one clock later.
  always_ff @(posedge clk_i) begin
    lined_q        <= boundary_q && !skip && !wait_on;
    started_q      <= start_line;
    starts_q       <= out_starts;
    head_first_q   <= line_q[0].first;
    head_current_q <= head_current;
    head_last_q    <= !line_q[0].first && row_is_last_q;
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
    rd_addr_q   <= along_q ? rd_addr_q + 1'b1 : base(rd_line_q);
    rd_col_q    <= along_q ? rd_col_q + 1'b1 : '0;
    rd_first_q  <= boundary_q;
    next_last_q <= rd_col_q == col_third_q;
    if (rst_i) begin
      rd_line_q     <= '0;
      boundary_q    <= 1'b1;
      along_q       <= 1'b0;
      reading_q     <= 1'b0;
      rd_active_q   <= 1'b0;
      rd_current_q  <= 1'b0;
      mid_frame_q   <= 1'b0;
      out_active_q  <= 1'b0;
      out_current_q <= 1'b0;
      ended_q       <= 1'b0;
    end else begin
      if (boundary_q && line_q[0].valid) rd_line_q <= next_line(rd_line_q);
      boundary_q    <= boundary;
      along_q       <= !boundary;
      rd_active_q   <= !skip && !wait_on;
      reading_q     <= start_line || (reading_q && !boundary_q);
      mid_frame_q   <= mid_frame;
      rd_current_q  <= rd_current && !event_start_q;
      out_active_q  <= out_active && !out_kill && !ended_q;
      out_current_q <= out_current && !event_start_q;
      ended_q       <= next_last_q && out_done_q;
    end
  end

  // ---- Issue: the line's flags are delayed by the ring's input register and its two clocks of latency; the border
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
  logic             ring_en_q;    // read enable at the ring
  logic [AddrW-1:0] ring_addr_q;
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
    bottom_q3   <= bottom_q2;
    away_q3     <= away_q2;
    ring_en_q   <= reading_q;
    ring_addr_q <= rd_addr_q;
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
  ) u_ring (
      .clk_i,
      .wr_en_i  (wr_en_q3),
      .wr_addr_i(wr_addr_q3),
      .wr_data_i(wr_data_q3),
      .rd_en_i  (ring_en_q),
      .rd_addr_i(ring_addr_q),
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
  assign busy_o      = active_q || event_commit_q || line_q[0].valid || rd_active_q || out_active_q || under_way_q;

  // The counters that follow one clock later need lines of a minimum length.
  `SLOG_ASSERT_INIT(SlogVideoInRadius, Radius >= 2)
  logic [2:0] used;
  assign used = 3'(line_q[0].valid) + 3'(line_q[1].valid) + 3'(line_q[2].valid) + 3'(reading_q);
  `SLOG_ASSERT(SlogVideoInRing, full_q == (used + 3'(event_commit_q) == 3'(Lines)))
  `SLOG_ASSERT(SlogVideoInBoundary, boundary_q == (!rd_active_q || rd_col_q == col_last_q) && along_q == !boundary_q)
  `SLOG_ASSERT(SlogVideoInHead, line_q[0].valid ? line_q[0].live == !line_q[0].dead
                                                : !line_q[0].current && !line_q[0].dead && !line_q[0].live)
  `SLOG_ASSERT(SlogVideoInAtEnd, !at_end_q || active_q)
  `SLOG_ASSERT(SlogVideoInClosed, !closed_q || !active_q)
  `SLOG_ASSERT(SlogVideoInFlags, start == (live && starts_q) && done == (live && ended_q) &&
                                 abort == (out_kill && !starts_q))
  `SLOG_ASSERT(SlogVideoInUnderWay, under_way_q == (valid_q != '0 || abort_q != '0))
  `SLOG_ASSERT(SlogVideoInCopies, outside_q == !active_q && room_q == !full_q)
  `SLOG_ASSERT(SlogVideoInEnd, !boundary_q || ended_q == (rd_active_q && out_done_q))
  `SLOG_ASSERT(SlogVideoInOneOut, !(out_starts && out_active && !ended_q && !out_kill))
  `SLOG_ASSERT(SlogVideoInSize, !wr_en || (32'(width_i) <= MaxWidth && 32'(width_i) >= 2 * Radius + 2
                                           && 32'(height_i) >= 2 * Radius + 2))
endmodule : slog_video_in
