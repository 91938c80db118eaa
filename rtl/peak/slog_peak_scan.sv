// SPDX-License-Identifier: Apache-2.0
// Scans a row together with the rows above and below it: outputs the columns next to the best, and the best of all
// other scores.
//
//   0  address to the banks     2  bank data     3  rows in order, columns marked: near_*
//   4  above against below      5  greater       6  against middle       7  greater, 0 near the best     10 far_valid_o
// Handshake  : order_room_o: an order may be issued in the next clock, unless one is issued in this clock.
// Latency    : column 0 is read one clock after the order, and once more in the next clock if it is the only column;
//              near_* three clocks after a column's read; far_* ten clocks after the last column's read.
// Throughput : one column per clock, rows back to back. An order takes last_x + 1 clocks, an order of one column two
//              (so that far_valid_o is high in every other clock at most), and never pauses.
// Formats    : scores as maybe_t; far_o is 0 where nothing is outside the neighbourhood.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_peak_scan
  import slog_pkg::*;
  import slog_peak_pkg::*;
  import slog_compare_pkg::*;
#(
    parameter int unsigned Banks = 4
) (
    input  logic                         clk_i,
    input  logic                         rst_i,
    input  logic                         order_valid_i,
    output logic                         order_room_o,
    input  scan_t                        order_i,
    // Row banks: data two clocks after the read.
    output logic [Banks-1:0]             read_o,
    output logic [9:0]                   read_x_o,
    input  logic [Banks-1:0][ScoreW-1:0] data_i,
    // A column of a row that holds the best so far.
    output logic                         near_first_o,   // first column of the scan
    output logic                         near_end_o,     // last column of the job, even if its row is not the best
    output logic                         near_west_o,    // west, centre, east: column left of, at, right of the best
    output logic                         near_centre_o,
    output logic                         near_east_o,
    output maybe_t                       near_above_o,
    output maybe_t                       near_middle_o,
    output maybe_t                       near_below_o,
    // Best of the three rows outside the neighbourhood.
    output logic                         far_valid_o,
    output maybe_t                       far_o
);
  // Marks of a column, delayed from its read to the row registers.
  typedef struct packed {
    logic first;
    logic last;
    logic fresh;
    logic job_end;
    logic west;
    logic centre;
    logic east;
  } column_t;

  // Stage 0.
  logic first_q, last_q;
  logic open_q;     // no order is active, or this is its last clock: order_i is loaded, valid or not
  logic reading_q;  // x_q is a column of the order; low in the clock before an only column
  logic room_q;     // no more than one clock of the order is left after this one
  logic [9:0] x_q, left_q;
  logic [10:0] until_q;  // columns from here to the best
  logic fresh_q, job_last_q, above_q, middle_q, below_q;
  logic [Banks-1:0] bank_q, next_bank, read_q;

  assign order_room_o = room_q;
  assign next_bank    = {bank_q[Banks-2:0], bank_q[Banks-1]};
  assign read_o       = read_q;
  assign read_x_o     = x_q;

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      open_q    <= 1'b1;
      last_q    <= 1'b0;
      room_q    <= 1'b1;
      reading_q <= 1'b0;
      read_q    <= '0;
      bank_q    <= Banks'(1) << (Banks - 1);
    end else if (order_valid_i) begin
      open_q    <= 1'b0;
      last_q    <= !open_q && room_q;
      room_q    <= order_i.brief;
      reading_q <= !order_i.only;
      read_q    <= !order_i.fresh ? '0 : (next_bank & {Banks{order_i.middle}})
                 | ({next_bank[0], next_bank[Banks-1:1]} & {Banks{order_i.above}})
                 | ({next_bank[Banks-2:0], next_bank[Banks-1]} & {Banks{order_i.below}});
      bank_q    <= next_bank;
    end else begin
      open_q    <= open_q || room_q;
      last_q    <= !open_q && room_q;
      room_q    <= room_q || left_q == 10'd2;
      reading_q <= !open_q;
      read_q    <= last_q ? '0 : read_q;
    end
  end

  always_ff @(posedge clk_i) begin
    if (open_q) begin
      fresh_q    <= order_i.fresh;
      job_last_q <= order_i.last;
      above_q    <= order_i.fresh && order_i.above;
      middle_q   <= order_i.fresh && order_i.middle;
      below_q    <= order_i.fresh && order_i.below;
      until_q    <= 11'(order_i.best_x);
      first_q    <= 1'b1;
      x_q        <= '0;
      left_q     <= order_i.last_x;
    end else if (reading_q) begin
      first_q <= 1'b0;
      x_q     <= x_q + 10'd1;
      left_q  <= left_q - 10'd1;
      until_q <= until_q - 11'd1;
    end
  end

  // Stages 1 to 7: valid bits, and data enabled by them.
  logic [7:1] valid_q;
  column_t s1_q, s2_q;
  logic s1_above_q, s1_middle_q, s1_below_q;
  logic [Banks-1:0] s1_bank_q;                              // bank of the scanned row, one-hot
  logic [Banks-1:0] s2_above_q, s2_middle_q, s2_below_q;    // banks of the rows, one-hot; 0 if the row is absent
  always_ff @(posedge clk_i) begin
    if (rst_i) valid_q <= '0;
    else valid_q <= {valid_q[6:1], reading_q};
  end

  always_ff @(posedge clk_i) begin
    if (reading_q) begin
      s1_q        <= '{first: first_q, last: last_q, fresh: fresh_q, job_end: job_last_q && last_q,
                       west: until_q == 11'd1, centre: until_q == '0, east: until_q == '1};
      s1_above_q  <= above_q;
      s1_middle_q <= middle_q;
      s1_below_q  <= below_q;
      s1_bank_q   <= bank_q;
    end
    if (valid_q[1]) begin
      s2_q        <= s1_q;
      s2_above_q  <= {s1_bank_q[0], s1_bank_q[Banks-1:1]} & {Banks{s1_above_q}};
      s2_middle_q <= s1_bank_q & {Banks{s1_middle_q}};
      s2_below_q  <= {s1_bank_q[Banks-2:0], s1_bank_q[Banks-1]} & {Banks{s1_below_q}};
    end
  end

  // The data of one bank; absent if bank is 0.
  function automatic maybe_t pick(logic [Banks-1:0][ScoreW-1:0] data, logic [Banks-1:0] bank);
    logic [ScoreW-1:0] value = '0;
    for (int b = 0; b < Banks; b++) value |= data[b] & {ScoreW{bank[b]}};
    return {|bank, value};
  endfunction

  logic s3_first_q, s3_last_q, s3_beside_q;
  // Gated with the valid bit; all but s3_end_q are set only for a row that holds the best so far.
  logic s3_end_q, s3_near_first_q, s3_west_q, s3_centre_q, s3_east_q;
  maybe_t s3_above_q, s3_middle_q, s3_below_q;
  logic s4_first_q, s4_last_q, s4_near_q;
  logic s4_above_wins_q;
  maybe_t s4_above_q, s4_middle_q, s4_below_q;
  logic s5_first_q, s5_last_q, s5_near_q;
  maybe_t s5_outer_q, s5_middle_q;
  logic s6_first_q, s6_last_q, s6_near_q;
  logic s6_outer_wins_q;
  maybe_t s6_outer_q, s6_middle_q;
  logic s7_first_q, s7_last_q;
  maybe_t s7_value_q;

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      {s3_end_q, s3_near_first_q, s3_west_q, s3_centre_q, s3_east_q} <= '0;
    end else begin
      s3_end_q        <= valid_q[2] && s2_q.job_end;
      s3_near_first_q <= valid_q[2] && s2_q.fresh && s2_q.first;
      s3_west_q       <= valid_q[2] && s2_q.fresh && s2_q.west;
      s3_centre_q     <= valid_q[2] && s2_q.fresh && s2_q.centre;
      s3_east_q       <= valid_q[2] && s2_q.fresh && s2_q.east;
    end
  end

  always_ff @(posedge clk_i) begin
    if (valid_q[2]) begin
      s3_first_q  <= s2_q.first;
      s3_last_q   <= s2_q.last;
      s3_beside_q <= s2_q.west || s2_q.centre || s2_q.east;
      s3_above_q  <= pick(data_i, s2_above_q);
      s3_middle_q <= pick(data_i, s2_middle_q);
      s3_below_q  <= pick(data_i, s2_below_q);
    end
    if (valid_q[3]) begin
      s4_first_q      <= s3_first_q;
      s4_last_q       <= s3_last_q;
      s4_near_q       <= s3_beside_q;
      s4_above_wins_q <= is_above(32'(s3_above_q), 32'(s3_below_q));
      s4_above_q      <= s3_above_q;
      s4_middle_q     <= s3_middle_q;
      s4_below_q      <= s3_below_q;
    end
    if (valid_q[4]) begin
      s5_first_q  <= s4_first_q;
      s5_last_q   <= s4_last_q;
      s5_near_q   <= s4_near_q;
      s5_outer_q  <= s4_above_wins_q ? s4_above_q : s4_below_q;
      s5_middle_q <= s4_middle_q;
    end
    if (valid_q[5]) begin
      s6_first_q      <= s5_first_q;
      s6_last_q       <= s5_last_q;
      s6_near_q       <= s5_near_q;
      s6_outer_wins_q <= is_above(32'(s5_outer_q), 32'(s5_middle_q));
      s6_outer_q      <= s5_outer_q;
      s6_middle_q     <= s5_middle_q;
    end
    if (valid_q[6]) begin
      s7_first_q <= s6_first_q;
      s7_last_q  <= s6_last_q;
      s7_value_q <= s6_near_q ? '0 : s6_outer_wins_q ? s6_outer_q : s6_middle_q;
    end
  end

  assign near_end_o    = s3_end_q;
  assign near_first_o  = s3_near_first_q;
  assign near_west_o   = s3_west_q;
  assign near_centre_o = s3_centre_q;
  assign near_east_o   = s3_east_q;
  assign near_above_o  = s3_above_q;
  assign near_middle_o = s3_middle_q;
  assign near_below_o  = s3_below_q;

  logic unused_index;
  slog_running_max #(.ValueW(ScoreW + 1), .IndexW(1)) u_far (
      .clk_i, .rst_i, .in_valid_i(valid_q[7]), .in_first_i(s7_first_q), .in_last_i(s7_last_q),
      .in_value_i(s7_value_q), .in_index_i(1'b0),
      .out_valid_o(far_valid_o), .out_value_o(far_o), .out_index_o(unused_index));

  `SLOG_ASSERT(SlogPeakScanRoom, !order_valid_i || open_q)
  `SLOG_ASSERT(SlogPeakScanBank, $onehot(bank_q))
  `SLOG_PAST(past_order, {order_room_o, order_valid_i})
  `SLOG_ASSERT(SlogPeakScanOrder, !order_valid_i || (past_order[1] && !past_order[0]))
  `SLOG_ASSERT(SlogPeakScanBest, !order_valid_i || !order_i.fresh || order_i.best_x <= order_i.last_x)
  `SLOG_ASSERT(SlogPeakScanColumn, $onehot0({near_west_o, near_centre_o, near_east_o}))
  `SLOG_ASSERT_NEXT(SlogPeakScanFarApart, far_valid_o, !far_valid_o)
endmodule : slog_peak_scan
