// SPDX-License-Identifier: Apache-2.0
// slog_video_in's receiver against its header: which lines are good, which frames are dropped, how often that is counted;
// and what is issued: whole lines, each good one six clocks after its last pixel, with that line's pixels. Each frame
// whose output begins is aborted, or done with the last of its rows, before the next begins.
//
// One column is watched. The image size is any, and constant, as slog_filter_bank keeps it while a frame is under way.
module slog_rules_video_in #(
    parameter int unsigned MaxWidth = 8,
    parameter int unsigned Radius   = 2,
    parameter int unsigned ColW     = 3,
    parameter int unsigned AddrW    = 4
) (
    input logic             clk_i,
    input logic             rst_i,
    input logic [7:0]       tdata_i,
    input logic             tvalid_i,
    input logic             tready_o,
    input logic             tuser_i,
    input logic             tlast_i,
    input logic [9:0]       width_i,
    input logic [9:0]       height_i,
    input logic             abort_i,
    input logic             px_valid_o,
    input logic [7:0]       px_data_o,
    input logic [ColW-1:0]  px_col_o,
    input logic             px_first_o,
    input logic             px_last_o,
    input logic             px_start_o,
    input logic             px_out_o,
    input logic             px_done_o,
    input logic             px_abort_o,
    input logic             dropped_o,
    input logic             active_q,
    input logic             closed_q,
    input logic             stop_q,
    input logic             at_end_q,
    input logic             wr_en_q,
    input logic             event_start_q,
    input logic             event_last_q,
    input logic             event_commit_q,
    input logic             event_kill_q,
    input logic             drop_owed_q,
    input logic [9:0]       left_q,
    input logic [9:0]       wr_row_q,
    input logic             line_q,
    input logic             started_q,
    input logic             first_row_q,
    input logic             mid_frame_q,
    input logic [9:0]       rd_row_q,
    input logic             out_active_q,
    input logic             out_current_q,
    input logic             rd_current_q,
    input logic [9:0]       out_left_q,
    input logic             lined_q,
    input logic             line_out,
    input logic             rd_active_q,
    input logic [9:0]       rd_col_q,
    input logic             reading_q,
    input logic             wr_line_q,
    input logic             wr_en_q2,
    input logic             wr_en_q3,
    input logic             start_q2,
    input logic [AddrW-1:0] wr_addr_q2,
    input logic [AddrW-1:0] wr_addr_q3,
    input logic [AddrW-1:0] rd_addr_q,
    input logic [7:0]       mem[2*MaxWidth]
);
  logic [9:0] width, height, watched;
  slog_rules_choice #(.Width(30)) u_choice (.clk_i, .choice({width, height, watched}));

  // Receiver: in a frame; between frames; pixels of the line so far; lines complete.
  logic in_q, closed, beat, end_of_line, good, cut, bad_start;
  logic [9:0] x_q, y_q;
  logic [1:0] settled_q;     // clocks since power-up: the sizes are registered
  logic [1:0] drops_q, owed_q;  // frames dropped in the clock before; dropped earlier and not counted yet
  logic counted_q;
  logic [1:0] drops;
  assign beat        = tvalid_i && tready_o;
  assign end_of_line = x_q == width - 1'b1;
  assign good        = beat && in_q && !tuser_i && tlast_i && end_of_line;
  // Dropped: the frame that is cut, aborted or has a bad line, or stray pixels after one; and a start with tlast.
  assign cut         = stop_q ? in_q : beat && (in_q ? tuser_i || tlast_i != end_of_line : closed && !tuser_i);
  assign bad_start   = beat && tuser_i && tlast_i;
  assign drops       = 2'(cut) + 2'(bad_start);
  always_ff @(posedge clk_i) begin
    settled_q <= (settled_q == '1) ? settled_q : settled_q + 1'b1;
    if (rst_i) begin
      in_q      <= 1'b0;
      closed    <= 1'b1;
      drops_q   <= '0;
      owed_q    <= '0;
      counted_q <= 1'b0;
    end else begin
      drops_q   <= drops;
      owed_q    <= (drops_q + owed_q == '0) ? '0 : drops_q + owed_q - 1'b1;
      counted_q <= drops_q + owed_q != '0;
      if (cut) in_q <= 1'b0;
      if (cut || beat) closed <= 1'b0;
      if (beat && tuser_i) begin
        in_q <= !tlast_i;
        x_q  <= 10'd1;
        y_q  <= '0;
      end else if (good) begin
        x_q <= '0;
        y_q <= y_q + 1'b1;
        if (y_q == height - 1'b1) begin
          in_q   <= 1'b0;
          closed <= 1'b1;
        end
      end else if (beat) begin
        x_q <= x_q + 1'b1;
      end
    end
  end

  // Issue: a good line not followed by a drop in the next clock starts five clocks after that.
  logic [4:0] begins_q;        // [k]: such a line ended k + 2 clocks ago
  logic pending;               // the latest line is on its way from the receiver to the scheduler
  assign pending = event_commit_q || line_q || started_q;
  int unsigned left, row;      // output rows left after this one; lines of the frame being read that were started
  logic own;                   // the output frame is the one being read
  assign left = 32'(out_left_q);
  assign row  = 32'(rd_row_q);
  assign own  = row > Radius;
  logic good_q, past_last_q, past_valid_q;
  logic [ColW-1:0] past_col_q;
  always_ff @(posedge clk_i) begin
    past_valid_q <= px_valid_o && !rst_i;
    past_last_q  <= px_last_o;
    past_col_q   <= px_col_o;
    if (rst_i) begin
      good_q   <= 1'b0;
      begins_q <= '0;
    end else begin
      good_q   <= good;
      begins_q <= {begins_q[3:0], good_q && !cut};
    end
  end

  // Output frames: one is open from px_start_o to px_done_o or px_abort_o.
  logic open_q;
  logic [2:0] actives_q;   // [k]: out_active_q k + 1 clocks ago
  logic [9:0] rows_q;      // output rows that have ended
  logic [2:0][9:0] rows_left_q;  // [k]: rows not begun k + 1 clocks ago
  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      open_q    <= 1'b0;
      actives_q <= '0;
    end else begin
      open_q    <= px_start_o || (open_q && !px_done_o && !px_abort_o);
      actives_q <= {actives_q[1:0], out_active_q};
    end
    rows_left_q <= {rows_left_q[1:0], out_left_q - 10'(!rd_active_q || lined_q)};
    if (px_start_o) rows_q <= '0;
    else rows_q <= rows_q + 10'(px_last_o && px_out_o && px_valid_o);
  end

  // Buffers: that of the line being received, and of the line being read; a pixel's address, one to three clocks later.
  logic buffer_q, reads_q;
  logic [AddrW-1:0] addr, addr_q, addr_q2, addr_q3;
  function automatic logic [AddrW-1:0] place(logic line, logic [9:0] column);
    return AddrW'((line ? MaxWidth : 0) + 32'(column));
  endfunction
  assign addr = place(buffer_q, (beat && tuser_i) ? '0 : x_q);
  always_ff @(posedge clk_i) begin
    addr_q  <= addr;
    addr_q2 <= addr_q;
    addr_q3 <= addr_q2;
    if (rst_i) buffer_q <= 1'b0;
    else if (good) buffer_q <= !buffer_q;
    if (line_q && !event_kill_q) reads_q <= !buffer_q;
  end

  // The watched column's pixel: of the line being received, of the last good line, of the line being issued.
  logic [7:0] value, value_q, line_value_q, issued_value_q;
  logic [1:0] age_q;       // clocks since it came, up to 3
  logic [2:0] line_age_q;  // clocks since a good line ended, up to 7
  logic lined, issuing_q;  // there was a good line; a line, not a filler, is being issued
  logic [2:0] readings_q;  // [k]: a line, not a filler, was being read k + 1 clocks ago
  logic watch;
  assign watch = beat && (tuser_i ? watched == '0 : in_q && x_q == watched);
  assign value = watch ? tdata_i : value_q;
  always_ff @(posedge clk_i) begin
    value_q <= value;
    if (watch) age_q <= '0;
    else if (age_q != '1) age_q <= age_q + 1'b1;
    if (good) begin
      line_value_q <= value;
      line_age_q   <= '0;
    end else if (line_age_q != '1) line_age_q <= line_age_q + 1'b1;
    if (begins_q[3]) issued_value_q <= line_value_q;
    if (rst_i) begin
      lined      <= 1'b0;
      issuing_q  <= 1'b0;
      readings_q <= '0;
    end else begin
      lined      <= lined || good;
      issuing_q  <= begins_q[3] || (issuing_q && !px_last_o);
      readings_q <= {readings_q[1:0], reading_q};
    end
  end

  always_ff @(posedge clk_i) begin
    AssumeSize : assume (width_i == width && 32'(width) <= MaxWidth && 32'(width) >= 2 * Radius + 2
                         && watched < width && height_i == height && 32'(height) >= 2 * Radius + 2);
    if (!rst_i) begin
      RulesVideoState : assert (active_q == in_q && closed_q == closed);
      RulesVideoAtEnd : assert (at_end_q == (in_q && end_of_line));
      RulesVideoRow : assert (!in_q || wr_row_q + 10'(event_commit_q) == y_q || event_start_q);
      RulesVideoRowRange : assert (!in_q || y_q < height);
      RulesVideoLeft : assert (!in_q || event_start_q || left_q + x_q == (event_commit_q ? '0 : wr_en_q ? width
                                                                        : width - 1'b1));
      RulesVideoColumn : assert (!in_q || (x_q < width && (!event_start_q || (x_q == 10'd1 && y_q == '0 && wr_en_q))
                                 && (!event_commit_q || (x_q == '0 && wr_en_q))));
      RulesVideoDrops : assert (2'(event_kill_q) + 2'(event_start_q && event_last_q) == drops_q
                                && 2'(drop_owed_q) == owed_q);
      // Two drops at once end a frame, and another must begin, which drops none, before there can be two again.
      RulesVideoOwed : assert (owed_q <= 2'd1 && !(drops_q == 2'd2 && (in_q || closed || owed_q != '0))
                               && !(owed_q != '0 && in_q && drops_q != '0));
      RulesVideoCounted : assert (dropped_o == counted_q);
      RulesVideoGood : assert (event_commit_q == good_q);
      // Lines of the frame that were started; the latest may be on its way. No filler starts between them.
      RulesVideoFirst : assert (!in_q || event_start_q || first_row_q == (y_q == '0 || (y_q == 10'd1 && event_commit_q)));
      RulesVideoStarted : assert (!in_q || y_q < (pending ? 10'd2 : 10'd1)
                                  || (mid_frame_q && rd_current_q && rd_row_q == y_q - 10'(pending)));
      RulesVideoMidFrame : assert (mid_frame_q ? pending || (rd_current_q && ((in_q && y_q != '0) || event_kill_q))
                                   : !event_commit_q || in_q);
      RulesVideoNew : assert (!in_q || event_start_q || y_q > (pending ? 10'd1 : 10'd0)
                              || !(rd_current_q || (out_active_q && out_current_q)));
      // The output frame is the one being read, or the one before it, whose last Radius rows are still to come.
      RulesVideoOut : assert (!out_active_q || (!mid_frame_q ? left <= Radius
                              : own ? left + row == 32'(height) + Radius && row > Radius && out_current_q == rd_current_q
                              : left + row <= Radius && !out_current_q));
      RulesVideoOutLast : assert (!out_active_q || left != 0 || rd_active_q);
      RulesVideoFrames : assert (px_start_o ? !open_q && !px_done_o && !px_abort_o
                                 : px_done_o ? open_q && !px_abort_o : !px_abort_o || open_q);
      RulesVideoLineOut : assert (!(out_active_q && rd_active_q) || line_out);
      RulesVideoRows : assert (!open_q || rows_q + rows_left_q[2] == height - 1'b1);
      RulesVideoDone : assert (!px_done_o || (px_valid_o && px_last_o && px_out_o && rows_q == height - 1'b1));
      RulesVideoOpen : assert (open_q == actives_q[2]);
      // A line that is being issued is done before the next is complete: the receiver is at most two pixels ahead.
      RulesVideoPace : assert (!rd_active_q || !in_q || x_q <= rd_col_q + 10'd2);
      RulesVideoReading : assert (!rd_active_q || rd_col_q < width);
      RulesVideoPaceEnd : assert (!(rd_active_q && event_commit_q) || rd_col_q + 10'd2 >= width);
      RulesVideoWhole : assert (past_valid_q && !past_last_q ? px_valid_o && !px_first_o && px_col_o == past_col_q + 1'b1
                                : !px_valid_o || (px_first_o && px_col_o == '0));
      RulesVideoLast : assert (!px_valid_o || px_last_o == (10'(px_col_o) == width - 1'b1));
      RulesVideoIssued : assert (!begins_q[4] || (px_valid_o && px_first_o));
      RulesVideoBuffer : assert (wr_line_q == (buffer_q ^ event_commit_q));
      RulesVideoAddress : assert (!wr_en_q3 || wr_addr_q3 == addr_q3);
      RulesVideoNextAddress : assert (wr_en_q2 ? start_q2 || wr_addr_q2 == addr_q2
                                      : wr_en_q ? event_start_q || wr_addr_q2 == addr_q : !in_q || wr_addr_q2 == place(buffer_q, x_q));
      RulesVideoReadAddress : assert (!reading_q || (rd_active_q && rd_addr_q == place(reads_q, rd_col_q)));
      RulesVideoApart : assert (!reading_q || reads_q != buffer_q || event_commit_q || line_q);
      RulesVideoStored : assert (!(in_q && x_q > watched && age_q == '1) || mem[place(buffer_q, watched)] == value_q);
      RulesVideoKept : assert (!(lined && line_age_q >= 3'd3) || mem[place(!buffer_q, watched)] == line_value_q);
      RulesVideoIssuing : assert (issuing_q == readings_q[2] && (!issuing_q || px_valid_o) && (lined || !reading_q)
                                  && (!issuing_q || line_age_q != '1 || issued_value_q == line_value_q));
      RulesVideoData : assert (!(issuing_q && 10'(px_col_o) == watched) || px_data_o == issued_value_q);
      CoverPixel : cover (px_valid_o);
      CoverDropped : cover (dropped_o);
      CoverData : cover (issuing_q && 10'(px_col_o) == watched && watched != '0 && px_data_o == 8'd1 && value_q == 8'd2);
      CoverTwice : cover (owed_q != '0);
    end
  end
endmodule : slog_rules_video_in

bind slog_video_in slog_rules_video_in #(.MaxWidth(MaxWidth), .Radius(Radius), .ColW(ColW), .AddrW(AddrW)) u_rules (
    .mem(u_lines.mem_q), .*);
