// SPDX-License-Identifier: Apache-2.0
// Leads the dense engine through a pass: check, flush, rows as there is room for their words, the end.
//
// Sequence of a start: take the job -> mark the slots -> slog_dense_plan -> flush -> rows -> wait for the last row's feed and
// for the frames to be whole, which frees the slots -> wait until the sink has taken every word -> done. A refused job is done
// after the plan. Rows after the last one that has words are not sent. After a cancel, or when a frame of a live pass is lost,
// no row is started any more, and nothing is waited for but the feed; when all words of the rows under way have been taken,
// one word more ends the map (tail_o), unless the last row was already under way.
//
//   status = lost ? DenseLost : rows are missing || a frame is not whole ? DenseCancelled : DenseOk, when the slots are freed
//
//   clock  registers
//   0      start_i, with the job and the image's size
//   1      busy_o; the job is taken over from came_q
//   2      begin of the plan; slot_busy_o in the next clock
//   p      slog_dense_plan is done; flush_o from the clock after the next on, for Flush clocks
//   ..     row_o, plan.pitch clocks or more apart
// Throughput : rows plan.pitch clocks apart as long as there is room for their words.
// Rules      : pitch_i is 8 or more, and constant from begin_o on. feed_busy_i is high pitch_i - 1 clocks after row_o at the
//              latest, until the row's last word has been read. start_i counts while busy_o is low. job_o, slots_o and
//              the image's size are constant from plan_o to done_o; while busy_o is low they follow the inputs.
//              there_i is of the next row from 4 clocks after row_o on, whole_i and lost_i are of slog_dense_live.
// Formats    : done_o comes in the last clock of busy_o; status_o is of the last start, from done_o on. stall_o: a row could
//              start but for the room: a clock in which it waits for its planes' rows is none. slot_busy_o: the planes'
//              slots while reading_o is high, each where keep_i says so.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_dense_pass
  import slog_dense_pkg::*;
  import slog_compare_pkg::*;
#(
    parameter int unsigned Flush = 424
) (
    input  logic                clk_i,
    input  logic                rst_i,
    input  logic                start_i,
    input  dense_job_t          job_i,
    input  logic                cancel_i,
    input  logic          [9:0] image_width_i,
    input  logic          [9:0] image_height_i,
    output logic          [7:0] slot_busy_o,
    output dense_job_t          job_o,
    output logic     [1:0][7:0] slots_o,       // of job_o's left, right plane, one-hot
    output logic          [9:0] image_width_o,
    output logic          [9:0] image_height_o,
    output logic                plan_o,        // start of slog_dense_plan
    input  logic                planned_i,
    input  dense_status_e       status_i,
    input  logic         [10:0] pitch_i,
    input  logic          [9:0] row_words_i,   // of the map in a row that has any
    output logic                begin_o,       // start of slog_dense_feed
    output logic                flush_o,
    output logic                clear_o,       // what comes out of the engine is not of a map
    output logic                row_o,
    input  logic                feed_busy_i,
    output logic          [9:0] words_o,       // slog_dense_room: of the next row
    output logic                reserve_o,
    output logic                reading_o,     // from plan_o on, until nothing is read any more
    input  logic          [1:0] keep_i,        // slog_dense_live: of the left, the right plane
    input  logic                there_i,       // the next row's planes
    input  logic                whole_i,
    input  logic                lost_i,
    input  logic                room_i,
    input  logic                empty_i,
    output logic                tail_o,
    output logic                busy_o,
    output logic                done_o,
    output dense_status_e       status_o,
    output logic                stall_o
);
  localparam int unsigned FlushW = $clog2(Flush + 1);

  // One-hot state, in order.
  logic held_q;                        // neither idle_q nor take_q, for the enables of job_q
  logic idle_q, take_q, mark_q, plan_q, flush_q, rows_q, drain_q, empty_q, tail_q, over_q;
  dense_job_t came_q, job_q;           // job_i in the clock before: it comes from afar; of the last start
  logic [9:0] width_came_q, height_came_q, width_q, height_q;
  dense_status_e status_q;
  logic quit_q, early_q;               // a cancel came, or a frame is lost; it ends the map early
  logic [FlushW-1:0] flush_left_q;
  logic flushed_q;                     // flush_left_q is 0
  logic [11:0] again_q;                // wait_q after a row
  logic [11:0] wait_q;                 // clocks until a row may start, less one: negative when they are over
  logic due_q;                         // they are
  logic [9:0] rows_left_q;
  logic more_q;                        // a row is left that has words
  logic [7:0] gap_q;                   // rows until the next that has words
  logic has_q;                         // gap_q is 0
  logic feed_busy_q;                   // feed_busy_i
  logic planned_q, bad_q;              // planned_i, and whether the job is refused
  dense_status_e plan_status_q;        // status_i: DenseOk if it is not
  logic reading_q;                     // the job's slots are marked: in the states from mark to drain
  logic [9:0] words_q;
  logic whole_q;                       // !tail_q, for the way to the map
  logic row_q, reserve_q, tail_out_q, tail_out_q2, begin_q, stall_q, clear_q, ready, go, stop, freed, ended, refused;
  logic [1:0][7:0] slots_q;            // of the job: left, right
  logic [7:0] slot_busy_q;             // those that are marked

  assign stop    = rows_q && due_q && (!more_q || quit_q);
  assign ready   = rows_q && due_q && more_q && !quit_q;
  assign go      = ready && room_i && there_i;
  assign freed   = drain_q && !feed_busy_q && (whole_i || quit_q);
  assign refused = planned_q && bad_q;
  assign ended   = empty_q && empty_i;

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      idle_q      <= 1'b1;
      held_q      <= 1'b0;
      reading_q   <= 1'b0;
      planned_q   <= 1'b0;
      take_q      <= 1'b0;
      mark_q      <= 1'b0;
      plan_q      <= 1'b0;
      flush_q     <= 1'b0;
      rows_q      <= 1'b0;
      drain_q     <= 1'b0;
      empty_q     <= 1'b0;
      tail_q      <= 1'b0;
      over_q      <= 1'b0;
      begin_q     <= 1'b0;
      row_q       <= 1'b0;
      reserve_q   <= 1'b0;
      whole_q     <= 1'b1;
      tail_out_q  <= 1'b0;
      tail_out_q2 <= 1'b0;
      stall_q     <= 1'b0;
      clear_q     <= 1'b1;
      slot_busy_q <= '0;
      status_q    <= DenseOk;
    end else begin
      idle_q      <= (idle_q && !start_i) || over_q;
      held_q      <= !(idle_q || over_q);
      reading_q   <= take_q || (reading_q && !refused && !freed);
      planned_q   <= planned_i && plan_q && !planned_q;
      take_q      <= idle_q && start_i;
      mark_q      <= take_q;
      plan_q      <= mark_q || (plan_q && !planned_q);
      flush_q     <= (planned_q && !bad_q) || (flush_q && !flushed_q);
      rows_q      <= (flush_q && flushed_q) || (rows_q && !stop);
      drain_q     <= stop || (drain_q && !freed);
      empty_q     <= freed || tail_q || (empty_q && !ended);
      tail_q      <= ended && early_q;
      over_q      <= refused || (ended && !early_q);
      begin_q     <= planned_q && !bad_q;
      row_q       <= go;
      reserve_q   <= (go && has_q) || (ended && early_q);
      whole_q     <= !(ended && early_q);
      tail_out_q  <= !whole_q;
      tail_out_q2 <= tail_out_q;
      stall_q     <= ready && there_i && !room_i;
      clear_q     <= !(rows_q || drain_q || empty_q || tail_q);
      slot_busy_q <= ((slots_q[0] & {8{keep_i[0]}}) | (slots_q[1] & {8{keep_i[1]}})) & {8{reading_q}};
      if (planned_q) status_q <= plan_status_q;
      else if (freed) status_q <= lost_i ? DenseLost : early_q || !whole_i ? DenseCancelled : DenseOk;
    end
  end

  always_ff @(posedge clk_i) begin
    plan_status_q <= status_i;
    bad_q         <= status_i != DenseOk;
    has_q         <= gap_q == '0;
    feed_busy_q   <= feed_busy_i;
    came_q        <= job_i;
    width_came_q  <= image_width_i;
    height_came_q <= image_height_i;
    if (!held_q) begin
      job_q    <= came_q;
      for (int unsigned s = 0; s < 8; s++) begin
        slots_q[0][s] <= came_q.left_slot == 3'(s);
        slots_q[1][s] <= came_q.right_slot == 3'(s);
      end
      width_q  <= width_came_q;
      height_q <= height_came_q;
      early_q  <= 1'b0;
    end else if (stop) begin
      early_q  <= more_q;
    end else if (tail_q) begin
      early_q  <= 1'b0;
    end
    quit_q       <= !idle_q && (quit_q || cancel_i || lost_i);
    flush_left_q <= flush_q ? flush_left_q - 1'b1 : FlushW'(Flush - 1);
    flushed_q    <= flush_q && 32'(flush_left_q) == 1;
    again_q      <= 12'(pitch_i) - 12'd4;
    wait_q       <= row_q ? again_q : wait_q - 1'b1;
    due_q        <= flush_q || (due_q ? !go : !row_q && wait_q[11]);
    if (flush_q) begin
      rows_left_q <= height_q;
      gap_q       <= '0;
    end else if (row_q) begin
      rows_left_q <= rows_left_q - 1'b1;
      gap_q       <= (has_q ? job_q.step_y : gap_q) - 1'b1;
    end
    more_q  <= is_above(32'(rows_left_q), 32'(gap_q));
    words_q <= empty_q || tail_q ? 10'd1 : has_q ? row_words_i : '0;
  end

  assign slot_busy_o    = slot_busy_q;
  assign job_o          = job_q;
  assign slots_o        = slots_q;
  assign image_width_o  = width_q;
  assign image_height_o = height_q;
  assign plan_o         = mark_q;
  assign begin_o        = begin_q;
  assign flush_o        = flush_q;
  assign clear_o        = clear_q;
  assign row_o          = row_q;
  assign words_o        = words_q;
  assign reserve_o      = reserve_q;
  assign reading_o      = reading_q;
  assign tail_o         = tail_out_q2;
  assign busy_o         = !idle_q;
  assign done_o         = over_q;
  assign status_o       = status_q;
  assign stall_o        = stall_q;

  `SLOG_ASSERT(SlogDensePassState,
               $onehot({idle_q, take_q, mark_q, plan_q, flush_q, rows_q, drain_q, empty_q, tail_q, over_q}))
  `SLOG_ASSERT_INIT(SlogDensePassFlush, Flush >= 6)
  `SLOG_ASSERT(SlogDensePassPlanned, !planned_q || plan_q)
  `SLOG_PAST(past_pitch, pitch_i)
  `SLOG_ASSERT(SlogDensePassPitch, !(begin_q || flush_q || rows_q) || 32'(pitch_i) >= 8)
  `SLOG_ASSERT(SlogDensePassConstant, !rows_q || pitch_i == past_pitch)
  `SLOG_ASSERT_KEPT(SlogDensePassJob, held_q, {job_q, slots_q, width_q, height_q})
  `SLOG_ASSERT(SlogDensePassHas, !row_q || has_q == (gap_q == '0))
  `SLOG_ASSERT(SlogDensePassCopies, held_q == !(idle_q || take_q) && whole_q == !tail_q &&
               reading_q == (mark_q || plan_q || flush_q || rows_q || drain_q))
endmodule : slog_dense_pass
