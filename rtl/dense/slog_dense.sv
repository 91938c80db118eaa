// SPDX-License-Identifier: Apache-2.0
// Dense search between two planes of the store: for every pixel of the left one the best of a row of offsets.
//
// golden/dense.py and golden/dense_job.py say what a job computes. A start reads both planes' rows from the store, sends them
// through slog_dense_engine, lets the right plane's winners agree or not, and sends a map_t for every step_x-th pixel of every
// step_y-th row, in raster order.
//
// Stage  registers
//   1    slog_dense_pass with slog_dense_plan, slog_dense_live, slog_dense_room: job, rows, room
//   2    slog_dense_feed: store to columns
//   3    slog_dense_engine: 2 * Offsets + 6 clocks
//   4    slog_dense_check: Offsets + 8
//   5    slog_dense_out: 9; the queue holds OutDepth words
// Latency    : from start_i to the first row 3 * Offsets + MaxWindow + 24 clocks and those that slog_dense_plan takes for many
//              words or far rows; from a row's start to its first word 3 * Offsets + 49 and plan_t.left_delay.
// Throughput : a pixel per clock in a row; rows max(image_width + 2 * Lanes + 1, Offsets + Width + 8) clocks apart.
// Flow       : the sink may stop for any time. A row starts when there is room for its words and those of the rows under
//              way, so no word is lost. With a sink that is always ready a row's places are taken for image_width + 3 *
//              Offsets + 51 + plan_t.left_delay clocks at most: none waits if OutDepth holds the words of that time.
// Rules      : start_i counts while busy_o is low; job and image size are taken over with it. image_width_i is 2 * Lanes or
//              more. No frame begins to be written into a slot in slot_busy_o. rd_data_i is StoreLatency clocks after
//              rd_valid_o. progress_i and clear_i: as slog_dense_live has them.
// Live       : the slots of a live job may have requests that captures serve, or will: then the pass is of the frame that the
//              request gets, and a row starts when those of both planes that it needs are in the store: row y of the left
//              one, y - down of the right one where the plane has it. Such a slot is not in slot_busy_o until its frame is
//              being written, so the request goes on; a slot without one holds its frame, and is as in any pass. Both frames
//              become whole, or the pass ends as by a cancel with DenseLost: when a frame is aborted, a request cancelled
//              or moved, or the image's size changed. It ends with DenseOk only when both are whole.
// Cancel     : no row is started any more; the words under way are followed by one in which nothing is found, with
//              map_tlast_o. If the last row that has words had begun, the map is whole and the status DenseOk.
// Refusal    : done_o with the status, and no word.
// Formats    : map_t. Bit 0 of a store word is the leftmost pixel; word w of row y of slot s is (s * MaxHeight + y) *
//              WordsPerRow + w.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_dense
  import slog_dense_pkg::*;
  import slog_store_pkg::*;
#(
    parameter  int unsigned Width       = 64,
    parameter  int unsigned MaxWidth    = 640,
    parameter  int unsigned MaxHeight   = 480,
    parameter  int unsigned WordsPerRow = 10,
    parameter  int unsigned Slots       = 3,
    parameter  int unsigned Offsets     = 128,
    parameter  int unsigned Lanes       = 8,
    parameter  int unsigned MaxWindow   = 32,
    parameter  int unsigned Sizes       = 3,
    parameter  int unsigned OutDepth    = 2048,
    parameter  int unsigned Cameras     = 2,
    localparam int unsigned AddrW       = $clog2(Slots * MaxHeight * WordsPerRow)
) (
    input  logic                   clk_i,
    input  logic                   rst_i,
    input  logic                   start_i,
    input  dense_job_t             job_i,
    input  logic                   cancel_i,
    input  logic       [      9:0] image_width_i,
    input  logic       [      9:0] image_height_i,
    input  logic       [      7:0] slot_valid_i,
    input  progress_t [Cameras-1:0] progress_i,
    input  logic                   clear_i,       // pulse in the first clock of another image size
    output logic       [      7:0] slot_busy_o,
    output logic                   rd_valid_o,
    output logic       [AddrW-1:0] rd_addr_o,
    input  logic       [Width-1:0] rd_data_i,
    output logic                   map_tvalid_o,
    input  logic                   map_tready_i,
    output logic       [     63:0] map_tdata_o,
    output logic                   map_tuser_o,   // first word of a map
    output logic                   map_tlast_o,   // last word of a map
    output logic                   busy_o,
    output logic                   done_o,        // last clock of busy_o: all words taken, or job refused
    output dense_status_e          status_o,      // of the last start, from done_o on
    output logic                   row_o,         // pulse: a row was started
    output logic                   stall_o        // a clock in which a row waited for room
);
  localparam int unsigned ShrinkW = (Sizes > 1) ? $clog2(Sizes) : 1;
  localparam int unsigned Flush   = 3 * Offsets + MaxWindow + 8;

  dense_job_t job;
  plan_t plan;
  logic [9:0] width, height, words;
  logic plan_start, planned, pass_begin, flush, clear, row, feed_busy, reserve, room, empty, taken, tail;
  logic reading, there, whole, lost;
  logic [1:0] here, keep;
  logic [1:0][7:0] slots;
  dense_status_e plan_status;

  slog_dense_pass #(
      .Flush(Flush)
  ) u_pass (
      .clk_i,
      .rst_i,
      .start_i,
      .job_i,
      .cancel_i,
      .image_width_i,
      .image_height_i,
      .slot_busy_o,
      .job_o         (job),
      .slots_o       (slots),
      .image_width_o (width),
      .image_height_o(height),
      .plan_o        (plan_start),
      .planned_i     (planned),
      .status_i      (plan_status),
      .pitch_i       (plan.pitch),
      .row_words_i   (plan.words),
      .begin_o       (pass_begin),
      .flush_o       (flush),
      .clear_o       (clear),
      .row_o         (row),
      .feed_busy_i   (feed_busy),
      .words_o       (words),
      .reserve_o     (reserve),
      .reading_o     (reading),
      .keep_i        (keep),
      .there_i       (there),
      .whole_i       (whole),
      .lost_i        (lost),
      .room_i        (room),
      .empty_i       (empty),
      .tail_o        (tail),
      .busy_o,
      .done_o,
      .status_o,
      .stall_o
  );
  assign row_o = row;

  slog_dense_plan #(
      .Width      (Width),
      .MaxHeight  (MaxHeight),
      .WordsPerRow(WordsPerRow),
      .Slots      (Slots),
      .Offsets    (Offsets),
      .Lanes      (Lanes),
      .MaxWindow  (MaxWindow),
      .Sizes      (Sizes)
  ) u_plan (
      .clk_i,
      .rst_i,
      .start_i       (plan_start),
      .job_i         (job),
      .image_width_i (width),
      .image_height_i(height),
      .slot_valid_i,
      .here_i        (here),
      .done_o        (planned),
      .status_o      (plan_status),
      .plan_o        (plan)
  );

  slog_dense_live #(
      .Cameras(Cameras),
      .Slots  (Slots)
  ) u_live (
      .clk_i,
      .rst_i,
      .begin_i     (plan_start),
      .reading_i   (reading),
      .live_i      (job.live),
      .slots_i     ({slots[1][Slots-1:0], slots[0][Slots-1:0]}),
      .down_i      (job.down),
      .row_i       (row),
      .progress_i,
      .slot_valid_i(slot_valid_i[Slots-1:0]),
      .clear_i,
      .here_o      (here),
      .keep_o      (keep),
      .there_o     (there),
      .whole_o     (whole),
      .lost_o      (lost)
  );

  slog_dense_room #(
      .Depth(OutDepth)
  ) u_room (
      .clk_i,
      .rst_i,
      .words_i  (words),
      .reserve_i(reserve),
      .taken_i  (taken),
      .room_o   (room),
      .empty_o  (empty)
  );

  logic left_valid, first, left_incoming, left_leaving, right_valid, right_incoming, right_leaving;
  logic [1:0] left_ok, right_ok;
  slog_dense_feed #(
      .Width      (Width),
      .WordsPerRow(WordsPerRow),
      .AddrW      (AddrW)
  ) u_feed (
      .clk_i,
      .rst_i,
      .begin_i         (pass_begin),
      .row_i           (row),
      .plan_i          (plan),
      .down_i          (job.down),
      .width_i         (width),
      .height_i        (height),
      .rd_valid_o,
      .rd_addr_o,
      .rd_data_i,
      .left_valid_o    (left_valid),
      .first_o         (first),
      .left_incoming_o (left_incoming),
      .left_leaving_o  (left_leaving),
      .left_ok_o       (left_ok),
      .right_valid_o   (right_valid),
      .right_incoming_o(right_incoming),
      .right_leaving_o (right_leaving),
      .right_ok_o      (right_ok),
      .busy_o          (feed_busy)
  );

  logic winner_valid, checked_valid;
  // slog_dense_check needs no valid of the right plane's winners.
  /* verilator lint_off UNUSEDSIGNAL */
  logic back_valid;
  /* verilator lint_on UNUSEDSIGNAL */
  winner_t winner;
  back_t back;
  checked_t checked;
  slog_dense_engine #(
      .Offsets  (Offsets),
      .Lanes    (Lanes),
      .MaxWindow(MaxWindow),
      .Sizes    (Sizes),
      .MaxWidth (MaxWidth)
  ) u_engine (
      .clk_i,
      .rst_i,
      .flush_i         (flush),
      .shrink_i        (plan.shrink[ShrinkW-1:0]),
      .offsets_i       (job.offsets),
      .left_valid_i    (left_valid),
      .first_i         (first),
      .left_incoming_i (left_incoming),
      .left_leaving_i  (left_leaving),
      .left_ok_i       (left_ok),
      .right_valid_i   (right_valid),
      .right_incoming_i(right_incoming),
      .right_leaving_i (right_leaving),
      .right_ok_i      (right_ok),
      .winner_valid_o  (winner_valid),
      .winner_o        (winner),
      .back_valid_o    (back_valid),
      .back_o          (back)
  );

  slog_dense_check #(
      .Offsets(Offsets)
  ) u_check (
      .clk_i,
      .rst_i,
      .winner_valid_i(winner_valid),
      .winner_i      (winner),
      .back_i        (back),
      .valid_o       (checked_valid),
      .checked_o     (checked)
  );

  slog_dense_out #(
      .Depth(OutDepth)
  ) u_out (
      .clk_i,
      .rst_i,
      .clear_i       (clear),
      .tail_i        (tail),
      .valid_i       (checked_valid),
      .pixel_i       (checked),
      .image_width_i (width),
      .image_height_i(height),
      .step_x_i      (job.step_x),
      .step_y_i      (job.step_y),
      .most_i        (job.most),
      .margin_i      (job.margin),
      .check_i       (job.check),
      .map_tvalid_o,
      .map_tready_i,
      .map_tdata_o,
      .map_tuser_o,
      .map_tlast_o,
      .taken_o       (taken)
  );

  `SLOG_ASSERT_INIT(SlogDenseOutDepth, OutDepth >= MaxWidth && MaxWidth >= 2 * Lanes)
  `SLOG_ASSERT_INIT(SlogDenseFlush, Flush > Offsets + Offsets / Lanes + 9)
  `SLOG_ASSERT(SlogDenseWidth, !(pass_begin && 32'(width) < 2 * Lanes))
  `SLOG_ASSERT(SlogDenseSlotBusy, !rd_valid_o || slot_busy_o[3'(32'(rd_addr_o) / (MaxHeight * WordsPerRow))])
endmodule : slog_dense
