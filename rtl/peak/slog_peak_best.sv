// SPDX-License-Identifier: Apache-2.0
// Decides for each complete row whether it holds the best score of its job so far, and issues the order to scan it.
//
// Row r, with maximum M at x, is the best so far if M is greater than the maximum of rows 0..r-1. The runner-up then is
// the greater of the maximum of rows 0..r-2 (known here) and of the best score outside the neighbourhood that the scan
// of rows r-1..r+1 finds; at a row two or more below the best it becomes the greater of itself and M.
//
// A row is complete for this purpose when the row below it has arrived too, or if there is none.
// Handshake  : order_valid_o is high for one clock, and only after a clock with order_room_i.
// Latency    : a row that is complete from clock t on (top_coming_i counted) is taken in clock t+1 at the earliest,
//              order_valid_o follows two clocks after that: load, compare.
// Throughput : a row in two clocks.
// Stalls     : a job's last row waits for room for its result: room_i in the clock before the order.
// Ties       : a row must exceed the best, so the first row wins; slog_running_max takes the first column of a row.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_peak_best
  import slog_pkg::*;
  import slog_peak_pkg::*;
  import slog_compare_pkg::*;
#(
    parameter  int unsigned RowDepth = 4,                // maximum number of waiting rows
    localparam int unsigned LevelW   = $clog2(RowDepth + 1)
) (
    input  logic              clk_i,
    input  logic              rst_i,
    // Rows begun, and the maxima of those that are complete, both in order.
    input  logic              row_valid_i,
    output logic              row_ready_o,
    input  row_t              row_i,
    input  logic [LevelW-1:0] top_level_i,
    input  logic              top_coming_i,   // top_level_i increases by one in the next clock
    output logic              top_ready_o,
    input  logic [ScoreW-1:0] top_score_i,
    input  logic [9:0]        top_x_i,
    // Room for one more result; room for an order in the next clock.
    input  logic              room_i,
    input  logic              order_room_i,
    // Order for the scan, and the outcome known so far.
    output logic              order_valid_o,
    output logic              outcome_valid_o,  // copy of order_valid_o
    output scan_t             order_o,
    output outcome_t          outcome_o,
    output logic [1:0]        released_o    // number of row banks that no later scan reads
);
  // The row being decided.
  logic held_q, open_q;  // a row is held and stays in the next clock; !held_q, a copy that enables the row's data
  logic hand_q, stay_q;  // the row leaves in this clock; !hand_q
  logic fresh_q, stale_q;  // the row holds the best so far; !fresh_q, a copy that selects the outcome's data
  logic refused_q, only_q, brief_q;  // only_q: one column, or refused; brief_q: two, or only_q
  logic [1:0] released_q;
  row_t row_q;
  logic more_q;  // !row_q.last
  logic edge_q;  // row_q.first || row_q.last
  logic [ScoreW-1:0] top_q;
  logic [9:0] top_x_q;
  // The job so far.
  logic [ScoreW-1:0] best_q;
  logic [9:0] best_x_q, best_y_q;
  maybe_t before_q;  // best of rows 0..r-2; 0 between jobs
  logic far_q;       // the best is two rows above this one, or more
  // The row that waits.
  logic complete_q, top_used_q;  // not valid in the clock after a row is taken: held_q is set then
  logic refused_next_q, only_next_q, brief_next_q;
  logic load, hand, refused, some, many, complete;

  assign refused     = row_i.status != StatusOk;
  assign some        = top_level_i != '0 || top_coming_i;
  assign many        = top_level_i > LevelW'(1) || (top_level_i == LevelW'(1) && top_coming_i);
  assign complete    = row_valid_i && (refused || many || (row_i.last && some));
  assign load        = !held_q && complete_q;
  assign row_ready_o = load;
  assign top_ready_o = !held_q && top_used_q;

  assign hand            = held_q && order_room_i && (room_i || more_q);
  assign order_valid_o   = hand_q;
  assign outcome_valid_o = !stay_q;
  assign released_o      = released_q;

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      held_q     <= 1'b0;
      open_q     <= 1'b1;
      complete_q <= 1'b0;
      top_used_q <= 1'b0;
      hand_q     <= 1'b0;
      stay_q     <= 1'b1;
      released_q <= '0;
    end else begin
      held_q     <= held_q ? !hand : complete_q;
      open_q     <= held_q ? hand : !complete_q;
      complete_q <= complete;
      top_used_q <= row_valid_i && !refused && (many || (row_i.last && some));
      hand_q     <= hand;
      stay_q     <= !hand;
      released_q <= {2{hand}} & (2'(!row_q.first) + 2'(row_q.last));
    end
  end

  always_ff @(posedge clk_i) begin
    refused_next_q <= refused;
    only_next_q    <= refused || row_i.last_x == '0;
    brief_next_q   <= refused || row_i.last_x[9:1] == '0;
    if (open_q) begin
      row_q     <= row_i;
      more_q    <= !row_i.last;
      edge_q    <= row_i.first || row_i.last;
      refused_q <= refused_next_q;
      only_q    <= only_next_q;
      brief_q   <= brief_next_q;
      top_q     <= refused_next_q ? '0 : top_score_i;
      top_x_q   <= refused_next_q ? '0 : top_x_i;
    end
    fresh_q <= row_q.first || is_above(32'(top_q), 32'(best_q));
    stale_q <= !(row_q.first || is_above(32'(top_q), 32'(best_q)));
    if (rst_i) before_q <= '0;
    else if (!stay_q) before_q <= edge_q ? '0 : {1'b1, best_q};
    if (!stay_q) begin
      far_q <= !fresh_q;
      if (!stale_q) begin
        best_q   <= top_q;
        best_x_q <= top_x_q;
        best_y_q <= row_q.y;
      end
    end
  end

  always_comb begin
    order_o = '{fresh: fresh_q, last: row_q.last, above: !row_q.first, middle: !refused_q, below: !row_q.last,
                only: !fresh_q || only_q, brief: !fresh_q || brief_q,
                last_x: row_q.last_x, best_x: top_x_q};
    outcome_o = '{fresh: fresh_q, last: row_q.last, other: '0, tag: row_q.tag, status: row_q.status,
                  best_x: stale_q ? best_x_q : top_x_q, best_y: stale_q ? best_y_q : row_q.y,
                  score: {!refused_q, stale_q ? best_q : top_q}};
    if (!stale_q) begin
      outcome_o.other = before_q;
    end else if (far_q) begin
      outcome_o.other = {1'b1, top_q};
    end
  end

  `SLOG_ASSERT(SlogPeakBestRow, !load || (row_valid_i && refused == refused_next_q))
  `SLOG_ASSERT(SlogPeakBestCopies, open_q == !held_q && stay_q == !hand_q && stale_q == !fresh_q &&
                                     (!(held_q || hand_q) ||
                                      (more_q == !row_q.last && edge_q == (row_q.first || row_q.last))))
  `SLOG_ASSERT_STABLE(SlogPeakBestRowStable, row_valid_i, row_ready_o, row_i)
  `SLOG_PAST(past_room, {order_room_i, room_i})
  `SLOG_ASSERT(SlogPeakBestOrder, !order_valid_o || (past_room[1] && (past_room[0] || !order_o.last)))
  `SLOG_ASSERT_NEXT(SlogPeakBestOrdersApart, order_valid_o, !order_valid_o)
endmodule : slog_peak_best
