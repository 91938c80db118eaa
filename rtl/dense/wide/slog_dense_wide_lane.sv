// SPDX-License-Identifier: Apache-2.0
// Mismatches of one offset's windows at four columns of a row per clock, as running sums.
//
//   a(x, y)  = L(x, y) ^ R(x - d, y)                                  d is the lane's offset; columns x = 4t .. 4t+3
//   c(x, y)  = a(x, y) - a(x, y-W);  e(x, y) = c(x, y) - c(x-W, y)
//   delta(t) = delta(t-1) + e(4t) + e(4t+1) + e(4t+2) + e(4t+3)       of the word's last column
//   last(t, y)     = last(t, y-1) + delta(t)                          mismatches of the window that ends at (4t+3, y)
//   less_j(t, y)   = less_j(t, y-1) + e(4t+j+1) + .. + e(4t+3)        last less the sum of column 4t+j, j = 0, 1, 2
//   sum(4t+j, y)   = last(t, y) - less_j(t, y);  sum(4t+3, y) = last(t, y)
//
// The sums of the four e are made before the accumulator, whose loop is one short adder. What one row leaves in delta has
// left it a window's width later, because the bits of W columns ago are those that came in W / 4 clocks before.
//
// Stage  registers                        valid after the clock of left_i and right_i
//   1    now_q ago_q                      1: c of the four columns, and that of W columns ago
//   2    e_q                              2
//   3    front_q back_q e1_q e3_q         3: e of the columns 0 and 1, of 2 and 3
//   4    all_q back_q2 e1_q2 e3_q2        4
//   5    delta_q behind_q back_q3 e3_q3   5: behind: e of the columns 1, 2 and 3
//   6    sums_o                           6: above_i is the same word in the row above, taken at 5
//   7    score_o                          7: ok_i is taken at 6; column j is score_o[j]
// Latency    : as above.
// Throughput : four pixels per clock.
// Formats    : c is -1..1, e -2..2, delta -W..W; see wide_sums_t. A sum is 0..W*W where the window lies in both planes, else
//              anything; its score is absent then.
// Rules      : clear_i is held until the streams have been 0 for W / 4 + 5 clocks; then delta is what came in since. W is the
//              user's: a multiple of 4, 32 or less.
`include "slog_assert.svh"
module slog_dense_wide_lane
  import slog_dense_wide_pkg::*;
(
    input  logic                      clk_i,
    input  logic                      clear_i,
    input  wide_bits_t                left_i,
    input  wide_bits_t                right_i,   // of the columns that the offset sets against those of left_i
    input  logic        [Columns-1:0] ok_i,
    input  wide_sums_t                above_i,
    output wide_sums_t                sums_o,
    output wide_score_t [Columns-1:0] score_o
);
  import slog_dense_pkg::*;
  localparam int unsigned DeltaBits = 7;

  logic [Columns-1:0][1:0] now_q, ago_q;            // two's complement, as all that follows
  logic signed [Columns-1:0][2:0] e_q;
  logic signed [3:0] front_q, back_q, back_q2, back_q3, behind_q;
  logic signed [2:0] e1_q, e1_q2, e3_q, e3_q2, e3_q3;
  logic signed [4:0] all_q;
  logic signed [DeltaBits-1:0] delta_q;
  wide_sums_t sums_q;
  wide_score_t [Columns-1:0] score_q;
  wide_bits_t a;

  // c, of whether the bit that comes in differs and whether the one that leaves does: each bit is one look-up table.
  function automatic logic [1:0] change(logic comes, logic leaves);
    return {leaves && !comes, comes ^ leaves};
  endfunction

  // c less that of W columns ago. Written as logic: an adder of three bits would take a carry chain of its own.
  function automatic logic [2:0] difference(logic [1:0] now, logic [1:0] ago);
    logic borrow, borrow2;
    borrow  = ago[0] && !now[0];
    borrow2 = (ago[1] && !now[1]) || (borrow && !(now[1] ^ ago[1]));
    return {now[1] ^ ago[1] ^ borrow2, now[1] ^ ago[1] ^ borrow, now[0] ^ ago[0]};
  endfunction

  assign a = left_i ^ right_i;

  always_ff @(posedge clk_i) begin
    for (int unsigned j = 0; j < Columns; j++) begin
      now_q[j] <= change(a.incoming[j], a.leaving[j]);
      ago_q[j] <= change(a.incoming_ago[j], a.leaving_ago[j]);
      e_q[j]   <= difference(now_q[j], ago_q[j]);
    end
    front_q  <= 4'(signed'(e_q[0])) + 4'(signed'(e_q[1]));
    back_q   <= 4'(signed'(e_q[2])) + 4'(signed'(e_q[3]));
    e1_q     <= e_q[1];
    e3_q     <= e_q[3];
    all_q    <= 5'(front_q) + 5'(back_q);
    back_q2  <= back_q;
    e1_q2    <= e1_q;
    e3_q2    <= e3_q;
    delta_q  <= clear_i ? '0 : delta_q + DeltaBits'(all_q);
    behind_q <= 4'(e1_q2) + back_q2;
    back_q3  <= back_q2;
    e3_q3    <= e3_q2;
    sums_q.last  <= above_i.last + sum_t'(delta_q);
    sums_q.less0 <= above_i.less0 + 8'(behind_q);
    sums_q.less1 <= above_i.less1 + 8'(back_q3);
    sums_q.less2 <= above_i.less2 + 7'(e3_q3);
    score_q[0] <= '{absent: !ok_i[0], sum: sums_q.last - sum_t'(sums_q.less0)};
    score_q[1] <= '{absent: !ok_i[1], sum: sums_q.last - sum_t'(sums_q.less1)};
    score_q[2] <= '{absent: !ok_i[2], sum: sums_q.last - sum_t'(sums_q.less2)};
    score_q[3] <= '{absent: !ok_i[3], sum: sums_q.last};
  end

  assign sums_o  = sums_q;
  assign score_o = score_q;

  `SLOG_ASSERT_INIT(SlogDenseWideLaneWord, Columns == 4)
`ifndef SYNTHESIS
  localparam int unsigned MaxWindow = 32;
  localparam int unsigned Calm      = MaxWindow / Columns + 5;
  logic [3:0] calm_q;  // clocks for which the streams have been 0, up to Calm
  logic known_q;       // delta is what came in since clear_i, whatever the window is
  always_ff @(posedge clk_i) begin
    calm_q <= {left_i, right_i} != '0 ? '0 : calm_q + 4'(32'(calm_q) < Calm);
    if (clear_i) known_q <= 32'(calm_q) == Calm;
  end
`endif
  `SLOG_ASSERT_NO_RESET(SlogDenseWideLaneDelta, !known_q ||
                        (32'(delta_q) <= int'(MaxWindow) && 32'(delta_q) >= -int'(MaxWindow)))
endmodule : slog_dense_wide_lane
