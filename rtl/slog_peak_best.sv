// Decides for each complete row whether it holds the best score of its job so far, and orders its scan.
//
// Row r, with maximum M at x, is the best so far when M is greater than the maximum of rows 0..r-1. The runner-up then is the
// greater of rows 0..r-2 (known here) and of what the scan of rows r-1..r+1 finds outside the neighbourhood; for
// rows two or more below the best it is the greater of itself and M.
//
// A row is complete for this purpose when the row below it has come in too, or there is none.
// Latency    : order_valid_o two clocks after the row is taken: load, compare.
// Throughput : a row in two clocks.
// Stalls     : a job's last row waits for room for its result (room_i); order_ready_i is the scan's.
// Ties       : a row must beat the best, so the first row wins; within a row the first column came first.
module slog_peak_best
  import slog_pkg::*;
  import slog_peak_pkg::*;
  import slog_compare_pkg::*;
#(
    parameter  int unsigned RowDepth = 4,                // rows in waiting, at most
    localparam int unsigned LevelW   = $clog2(RowDepth + 1)
) (
    input  logic              clk_i,
    input  logic              rst_i,
    // Rows begun, in order, and the maxima of those complete, in order.
    input  logic              row_valid_i,
    output logic              row_ready_o,
    input  row_t              row_i,
    input  logic [LevelW-1:0] top_level_i,
    output logic              top_ready_o,
    input  logic [ScoreW-1:0] top_score_i,
    input  logic [9:0]        top_x_i,
    // Room for one more result.
    input  logic              room_i,
    // Order for the scan, and what goes with it.
    output logic              order_valid_o,
    input  logic              order_ready_i,
    output scan_t             order_o,
    output outcome_t          outcome_o,
    output logic [1:0]        released_o    // row banks no later scan reads
);
  // The row being decided.
  logic valid_q, compared_q, fresh, refused_q, single_q;  // single_q: one column
  row_t row_q;
  partial_t against_q;  // its maximum against the best
  logic [ScoreW-1:0] top_q;
  logic [9:0] top_x_q;
  // The job so far.
  logic [ScoreW-1:0] best_q;
  logic [9:0] best_x_q, best_y_q;
  maybe_t before_q;  // best of rows 0..r-2
  logic [1:0] gap_q;  // rows from the best to this one, 2 = two or more
  logic complete, load, hand, refused;

  assign refused     = row_i.status != StatusOk;
  assign complete    = row_valid_i && (refused || top_level_i > LevelW'(1) || (row_i.last && top_level_i != '0));
  assign load        = complete && (!valid_q || hand);
  assign row_ready_o = load;
  assign top_ready_o = load && !refused;

  assign fresh         = row_q.first || is_above(against_q);
  assign order_valid_o = compared_q && (room_i || !row_q.last);
  assign hand          = order_valid_o && order_ready_i;
  assign released_o    = hand ? 2'(!row_q.first) + 2'(row_q.last) : 2'd0;

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      valid_q    <= 1'b0;
      compared_q <= 1'b0;
    end else begin
      if (load) valid_q <= 1'b1;
      else if (hand) valid_q <= 1'b0;
      compared_q <= valid_q && !hand;
    end
  end

  always_ff @(posedge clk_i) begin
    if (load) begin
      row_q     <= row_i;
      refused_q <= refused;
      single_q  <= row_i.last_x == '0;
      top_q     <= top_score_i;
      top_x_q   <= top_x_i;
    end
    if (valid_q) against_q <= compare(32'(top_q), 32'(best_q));
    if (hand) begin
      before_q <= row_q.first ? '0 : {1'b1, best_q};
      if (fresh) begin
        best_q   <= top_q;
        best_x_q <= top_x_q;
        best_y_q <= row_q.y;
        gap_q    <= 2'd1;
      end else begin
        gap_q    <= 2'd2;
      end
    end
  end

  always_comb begin
    order_o = '{fresh: fresh, last: row_q.last, above: fresh && !row_q.first, middle: fresh && !refused_q,
                below: fresh && !row_q.last, only: !fresh || refused_q || single_q,
                last_x: row_q.last_x, best_x: top_x_q};
    outcome_o = '{fresh: fresh, last: row_q.last, other: '0, tag: row_q.tag, status: row_q.status,
                  best_x: fresh ? top_x_q : best_x_q, best_y: fresh ? row_q.y : best_y_q,
                  score: {1'b1, fresh ? top_q : best_q}};
    if (refused_q) begin
      outcome_o.score  = '0;
      outcome_o.best_x = '0;
    end else if (fresh) begin
      outcome_o.other = row_q.first ? '0 : before_q;
    end else if (gap_q == 2'd2) begin
      outcome_o.other = {1'b1, top_q};
    end
  end
endmodule : slog_peak_best
