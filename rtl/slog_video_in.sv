// Receives frames, drops bad ones, and issues whole lines of width_i consecutive clocks to the LoG.
//
// A line enters the ring when its last pixel arrives in the right place; only such lines are issued, so everything
// behind works on uninterrupted lines. Output row r of a frame is computed while row r + Radius is issued. A frame's
// last Radius rows come out under the next frame's first lines or, while no frame is received, under filler lines.
//
// Stages     : 1 beat judged and written    2 line event    3 line started    4, 5 ring read
// Latency    : last pixel of a line accepted in clock t: its first pixel comes (px_valid_o) in clock t + 5, if idle.
// Throughput : one pixel per clock, no blanking. tready_o is low only while the ring is full or,
//              between frames, in hold_i.
// Frames     : a line that ends early or late, a start of frame before the last line's end, a pixel without start of
//              frame behind the last line: the frame is dropped whole, unless its last pixel has been issued already.
//              Then pixels are ignored up to the next start of frame. A dropped frame, or run of strays, counts once.
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
    output logic             px_out_o,     // an output row is computed under this line
    output logic             px_bottom_o,
    output logic [DistW-1:0] px_dist_o,
    output logic             px_live_o,    // the output pixel belongs to a frame not dropped so far
    output logic             px_start_o,   // first output pixel of a frame
    output logic             px_done_o,    // last output pixel of a frame
    output logic             px_abort_o,   // the frame started last is dropped: between pixels, in order with them
    output logic             accepted_o,
    output logic             dropped_o,
    output logic             busy_o
);
  localparam int unsigned Lines = 3;  // one written, one read, one for the clocks in which both change lines
  localparam int unsigned Depth = Lines * MaxWidth;
  localparam int unsigned AddrW = $clog2(Depth);

  typedef enum logic [1:0] {StClosed, StActive, StIgnore} state_e;

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

  // ---- Receiver: judges every beat. Its verdicts (event_*) reach the scheduler one clock later.
  state_e           state_q;
  logic [9:0]       wr_col_q, wr_row_q, col_last_q, row_last_q;
  logic [1:0]       wr_line_q;
  logic [AddrW-1:0] wr_addr_q, wr_addr;
  logic beat, at_end, good_end, kill, wr_en;
  logic event_commit_q, event_first_q, event_kill_q, event_start_q, event_drop_q, event_drop2_q, drop_owed_q;
  logic [1:0]       event_line_q;

  assign beat     = tvalid_i && tready_o;
  assign at_end   = wr_col_q == col_last_q;
  assign kill     = beat && ((state_q == StActive) ? (tuser_i || (tlast_i != at_end))
                                                   : (state_q == StClosed) && !tuser_i);
  assign good_end = beat && (state_q == StActive) && !tuser_i && tlast_i && at_end;
  assign wr_en    = beat && (tuser_i || (state_q == StActive));
  assign wr_addr  = tuser_i ? base(wr_line_q) : wr_addr_q;

  always_ff @(posedge clk_i) begin
    col_last_q <= width_i - 1'b1;
    row_last_q <= height_i - 1'b1;
    if (good_end) wr_addr_q <= base(next_line(wr_line_q));
    else if (wr_en) wr_addr_q <= wr_addr + 1'b1;
    if (wr_en) wr_col_q <= good_end ? '0 : tuser_i ? 10'd1 : wr_col_q + 1'b1;
    if (beat && tuser_i) wr_row_q <= '0;
    else if (good_end) wr_row_q <= wr_row_q + 1'b1;
    event_first_q <= wr_row_q == '0;
    event_line_q  <= wr_line_q;
    if (rst_i) begin
      state_q        <= StClosed;
      wr_line_q      <= '0;
      event_commit_q <= 1'b0;
      event_kill_q   <= 1'b0;
      event_start_q  <= 1'b0;
      event_drop_q   <= 1'b0;
      event_drop2_q  <= 1'b0;
      drop_owed_q    <= 1'b0;
    end else begin
      if (beat && tuser_i) state_q <= tlast_i ? StIgnore : StActive;
      else if (kill) state_q <= StIgnore;
      else if (good_end && wr_row_q == row_last_q) state_q <= StClosed;
      if (good_end) wr_line_q <= next_line(wr_line_q);
      event_commit_q <= good_end;
      event_kill_q   <= kill;
      event_start_q  <= beat && tuser_i;
      // A start of frame that is a whole line at once is a bad frame itself, beside the one it may cut short.
      event_drop_q   <= kill || (beat && tuser_i && tlast_i);
      event_drop2_q  <= kill && tuser_i && tlast_i;
      drop_owed_q    <= event_drop2_q || (event_drop_q && drop_owed_q);
    end
  end
  assign dropped_o = event_drop_q || drop_owed_q;

  // ---- Ring: what each committed line is. "Current" is the frame whose start of frame came last.
  logic [Lines-1:0] current_q, dead_q, first_q;
  logic [Lines-1:0] current, dead;
  logic [1:0]       level_q, rd_line_q;
  logic             rd_active_q, rd_real_q;
  logic             boundary, rd_last, take, start_line, start_filler;

  assign current  = event_start_q ? '0 : current_q;
  assign dead     = event_kill_q ? dead_q | current_q : dead_q;
  assign tready_o = (level_q + 2'(rd_active_q && rd_real_q) + 2'(event_commit_q) != 2'(Lines))
                    && !(hold_i && state_q != StActive);

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      current_q <= '0;
      dead_q    <= '0;
      first_q   <= '0;
      level_q   <= '0;
      rd_line_q <= '0;
    end else begin
      current_q <= current;
      dead_q    <= dead;
      if (event_commit_q) begin
        current_q[event_line_q] <= 1'b1;
        dead_q[event_line_q]    <= 1'b0;
        first_q[event_line_q]   <= event_first_q;
      end
      level_q <= level_q + 2'(event_commit_q) - 2'(take);
      if (take) rd_line_q <= next_line(rd_line_q);
    end
  end

  // ---- Scheduler: at a line boundary a committed line, else a filler if a complete frame still has rows to give.
  logic [9:0]       rd_col_q, rd_row_q, out_left_q;
  logic [AddrW-1:0] rd_addr_q;
  logic             rd_current_q, mid_frame_q;
  logic             out_active_q, out_current_q, out_begin_q;
  logic [DistW-1:0] out_top_q;
  logic             line_first, line_is_last, out_starts, out_kill;

  assign rd_last      = rd_col_q == col_last_q;
  assign boundary     = !rd_active_q || rd_last;
  assign take         = boundary && level_q != '0;
  assign start_line   = take && !dead[rd_line_q];
  assign start_filler = boundary && level_q == '0 && out_active_q && !out_kill && !(rd_active_q && out_left_q == '0)
                        && !mid_frame_q && state_q != StActive;
  assign line_first   = first_q[rd_line_q];
  assign line_is_last = !line_first && rd_row_q == row_last_q;
  assign out_starts   = start_line && !line_first && rd_row_q == 10'(Radius);
  assign out_kill     = event_kill_q && out_active_q && out_current_q;

  always_ff @(posedge clk_i) begin
    if (start_line) begin
      rd_addr_q <= base(rd_line_q);
      rd_row_q  <= line_first ? 10'd1 : rd_row_q + 1'b1;
    end else if (rd_active_q) begin
      rd_addr_q <= rd_addr_q + 1'b1;
    end
    if (start_line || start_filler) rd_col_q <= '0;
    else if (rd_active_q) rd_col_q <= rd_col_q + 1'b1;
    if (out_starts) begin
      out_top_q  <= '0;
      out_left_q <= row_last_q;
    end else if (start_line || start_filler) begin
      if (out_top_q != DistW'(Radius)) out_top_q <= out_top_q + 1'b1;
      out_left_q <= out_left_q - 1'b1;
    end
    if (rst_i) begin
      rd_active_q   <= 1'b0;
      rd_real_q     <= 1'b0;
      rd_current_q  <= 1'b0;
      mid_frame_q   <= 1'b0;
      out_active_q  <= 1'b0;
      out_current_q <= 1'b0;
      out_begin_q   <= 1'b0;
    end else begin
      if (boundary) begin
        rd_active_q <= start_line || start_filler;
        rd_real_q   <= start_line;
      end
      if (start_line) mid_frame_q <= !line_is_last;
      else if (event_kill_q && rd_current_q) mid_frame_q <= 1'b0;
      if (start_line) rd_current_q <= current[rd_line_q];
      else if (event_start_q) rd_current_q <= 1'b0;
      if (out_starts) out_active_q <= 1'b1;
      else if (out_kill || (rd_active_q && rd_last && out_left_q == '0)) out_active_q <= 1'b0;
      if (out_starts) out_current_q <= current[rd_line_q];
      else if (event_start_q) out_current_q <= 1'b0;
      out_begin_q <= out_starts || (out_begin_q && !rd_active_q);
    end
  end

  // ---- Issue: the ring's two clocks of latency carry the line's description along.
  typedef struct packed {
    logic             first;
    logic             last;
    logic             out;
    logic             live;
    logic             start;
    logic             done;
    logic             bottom;
    logic [DistW-1:0] away;
    logic [ColW-1:0]  col;
  } issue_t;
  issue_t issue, issue_q, issue_q2;
  logic   line_out_q, line_out, valid_q, valid_q2, abort_q, abort_q2, accepted_q;

  // A line keeps computing when its frame dies half-way along it, so the filters always see whole lines.
  assign line_out = (rd_col_q == '0) ? out_active_q : line_out_q;

  always_comb begin
    issue.first  = rd_col_q == '0;
    issue.last   = rd_last;
    issue.out    = line_out;
    issue.live   = out_active_q && !out_kill;
    issue.start  = issue.live && out_begin_q;
    issue.done   = issue.live && rd_last && out_left_q == '0;
    issue.bottom = out_left_q < 10'(Radius);
    issue.away   = issue.bottom ? DistW'(out_left_q) : out_top_q;
    issue.col    = ColW'(rd_col_q);
  end

  always_ff @(posedge clk_i) begin
    if (rd_active_q) begin
      line_out_q <= line_out;
      issue_q    <= issue;
    end
    if (valid_q) issue_q2 <= issue_q;
    if (rst_i) begin
      valid_q    <= 1'b0;
      valid_q2   <= 1'b0;
      abort_q    <= 1'b0;
      abort_q2   <= 1'b0;
      accepted_q <= 1'b0;
    end else begin
      valid_q    <= rd_active_q;
      valid_q2   <= valid_q;
      abort_q    <= out_kill && !out_begin_q;
      abort_q2   <= abort_q;
      accepted_q <= rd_active_q && issue.done;
    end
  end

  slog_ram #(
      .Width(8),
      .Depth(Depth)
  ) u_ring (
      .clk_i,
      .wr_en_i  (wr_en),
      .wr_addr_i(wr_addr),
      .wr_data_i(tdata_i),
      .rd_en_i  (rd_active_q && rd_real_q),
      .rd_addr_i(rd_addr_q),
      .rd_data_o(px_data_o)
  );

  assign px_valid_o  = valid_q2;
  assign px_col_o    = issue_q2.col;
  assign px_first_o  = issue_q2.first;
  assign px_last_o   = issue_q2.last;
  assign px_out_o    = issue_q2.out;
  assign px_bottom_o = issue_q2.bottom;
  assign px_dist_o   = issue_q2.away;
  assign px_live_o   = valid_q2 && issue_q2.live;
  assign px_start_o  = valid_q2 && issue_q2.start;
  assign px_done_o   = valid_q2 && issue_q2.done;
  assign px_abort_o  = abort_q2;
  assign accepted_o  = accepted_q;
  assign busy_o      = state_q == StActive || event_commit_q || level_q != '0 || rd_active_q || out_active_q
                       || valid_q || valid_q2 || abort_q || abort_q2;

  `SLOG_ASSERT_INIT(SlogVideoInRadius, Radius >= 1)
  `SLOG_ASSERT(SlogVideoInRing, level_q + 2'(rd_active_q && rd_real_q) <= 2'(Lines))
  `SLOG_ASSERT(SlogVideoInOneOut, !(out_starts && out_active_q && !(rd_active_q && rd_last && out_left_q == '0)
                                    && !out_kill))
  `SLOG_ASSERT(SlogVideoInSize, !wr_en || (32'(width_i) <= MaxWidth && 32'(width_i) >= 2 * Radius + 2
                                           && 32'(height_i) >= 2 * Radius + 2))
endmodule : slog_video_in
