// SPDX-License-Identifier: Apache-2.0
// slog_dense_pass: what it promises to slog_dense_room and slog_dense_feed, whatever these and the sink answer.
//
// A row reserves places only if there was room for just as many words in the clock before, a tail only if all were free;
// rows are pitch_i clocks apart at least, start only where their planes are there, and are never more than the image has. A
// pass ends with DenseOk only if its frames were whole when its slots were freed.
module slog_rules_dense_pass
  import slog_dense_pkg::*;
(
    input logic                 clk_i,
    input logic                 rst_i,
    input logic                 start_i,
    input logic                 cancel_i,
    input logic          [ 9:0] image_height_i,
    input logic                 busy_o,
    input logic                 planned_i,
    input dense_status_e        status_i,
    input logic          [10:0] pitch_i,
    input logic          [ 9:0] row_words_i,
    input logic                 row_o,
    input logic          [ 9:0] words_o,
    input logic                 reserve_o,
    input logic                 reading_o,
    input logic                 there_i,
    input logic                 whole_i,
    input logic                 lost_i,
    input logic                 room_i,
    input logic                 empty_i,
    input logic                 tail_o,
    input logic                 done_o,
    input dense_status_e        status_o,
    input logic                 idle_q,
    input logic                 take_q,
    input logic                 mark_q,
    input logic                 plan_q,
    input logic                 flush_q,
    input logic                 empty_q,
    input logic                 tail_q,
    input logic                 early_q,
    input logic          [11:0] again_q,
    input logic          [11:0] wait_q,
    input logic                 due_q,
    input logic                 rows_q,
    input logic          [ 9:0] rows_left_q,
    input logic          [ 9:0] height_q
);
  logic [10:0] since_q = '1;      // clocks since the last row, up to all ones
  logic [10:0] rows_seen_q;
  logic room_q, all_q, reserve_q, started_q, cancelled_q, busy_q, there_q, whole_q, lost_q, reading_q;
  logic [9:0] words_q, row_words_q;
  logic [10:0] pitch_q;
  always_ff @(posedge clk_i) begin
    room_q      <= room_i;
    all_q       <= empty_i;
    there_q     <= there_i;
    whole_q     <= whole_i;
    lost_q      <= lost_i;
    reading_q   <= reading_o && !rst_i;
    reserve_q   <= reserve_o;
    words_q     <= words_o;
    row_words_q <= row_words_i;
    pitch_q     <= pitch_i;
    busy_q      <= busy_o && !rst_i;
    since_q     <= row_o ? 11'd1 : since_q + 11'(since_q != '1);
    rows_seen_q <= idle_q ? '0 : rows_seen_q + 11'(row_o);
    cancelled_q <= !rst_i && busy_o && (cancelled_q || cancel_i);
    started_q   <= !rst_i;
    if (rst_i) since_q <= '1;
    if (!rst_i && started_q) begin
      AssumePitch : assume (pitch_i >= 11'd8 && pitch_i < 11'd1000 && pitch_i == pitch_q);
      AssumeWords : assume (row_words_i == row_words_q && row_words_i != '0);
      AssumeHeight : assume (image_height_i != '0);
      AssumePlanned : assume (!planned_i || plan_q);

      RulesDensePassRoom : assert (!reserve_o || (!tail_q && room_q) || (tail_q && all_q));
      RulesDensePassWords : assert (!reserve_o || tail_q || words_o == words_q);
      RulesDensePassOnce : assert (!reserve_o || !reserve_q);
      RulesDensePassPitch : assert (!row_o || since_q >= pitch_i);
      RulesDensePassRows : assert (idle_q || rows_seen_q + 11'(rows_left_q) == 11'(height_q) || !rows_q);
      RulesDensePassNone : assert (!(take_q || mark_q || plan_q || flush_q) || rows_seen_q == '0);
      RulesDensePassThere : assert (!row_o || there_q);
      RulesDensePassWhole : assert (!(reading_q && !reading_o) || status_o != DenseOk || (whole_q && !lost_q));
      RulesDensePassLost : assert (!(reading_q && !reading_o && lost_q && !done_o) || status_o != DenseCancelled);
      RulesDensePassTail : assert (!tail_o || status_o == DenseCancelled || status_o == DenseLost);
      CoverLost : cover (done_o && status_o == DenseLost && rows_seen_q == 11'd1);
      RulesDensePassDone : assert (!done_o || busy_o);
      // For the induction.
      RulesDensePassEarly : assert (!(early_q && (empty_q || tail_q)) || status_o == DenseCancelled ||
                                    status_o == DenseLost);
      RulesDensePassSince : assert (!rows_q || due_q || row_o || since_q >= pitch_i ||
                                    12'(since_q) + wait_q + 12'd3 == 12'(pitch_i));
      RulesDensePassAgain : assert (again_q + 12'd4 == 12'(pitch_i));
      RulesDensePassAfter : assert (rows_q || 12'(since_q) + 12'd1 >= 12'(pitch_i));
      RulesDensePassDue : assert (!rows_q || !due_q || row_o || 12'(since_q) + 12'd1 >= 12'(pitch_i));
      CoverSecondRow : cover (row_o && since_q == pitch_i);
      CoverTail : cover (tail_o);
      CoverDone : cover (done_o && status_o == DenseOk && rows_seen_q == 11'd2);
      CoverRefused : cover (done_o && status_o == DenseBadSlot);
    end
  end
endmodule : slog_rules_dense_pass

bind slog_dense_pass slog_rules_dense_pass u_rules (.*);
