// SPDX-License-Identifier: Apache-2.0
// Dense engine: a score for every pixel and every one of Offsets offsets, one pixel per clock.
//
//   M(x, y, k) = sum over i, j < W of L(x-i, y-j) ^ R(x-start-k-i, y-down-j)        W = MaxWindow >> shrink_i
//
// The planes' columns come with two rows each: the one that comes into the windows and the one that leaves them, W rows
// above. start and down are the feed's: they say which right pixel comes with a left one.
//
// Stage  registers                          valid after the clock of the pixels
//   1    left_q right_q ago_q               1: the bits, and those of W columns ago
//   2    slog_dense_group, one after another 2 * Offsets + 6: winner_o, of the left pixel; winner_valid_o with it
//        the same                           3 * Offsets + 6: back_o, of the right pixel; back_valid_o with it
// Latency    : as above.
// Throughput : one pixel per clock; nothing can stop it within a row.
// Formats    : see slog_dense_pkg. offsets_i: number of offsets that count, 1..Offsets; the others lose.
// Borders    : every pixel of a row has a winner; where no offset counts it is NoWinner. left_ok_i: the left window lies
//              in its plane, bit 0 in even rows and bit 1 in odd ones; right_ok_i: the same of the right plane.
// Ties       : the first of equals.
// Rules      : rows as in slog_dense_group. A right row begins up to Offsets - 1 clocks before the left one, or after it:
//              the right plane's pixel for offset 0 comes with the left one. In the first W rows the leaving bits are 0,
//              and so is each bit whose own row lies outside the plane. flush_i is held before a pass for Flush clocks
//              or more in which nothing is in a row, nor in the clock after them; shrink_i and offsets_i change only while
//              nothing is in a row, and are constant from the flush on.
// Reset      : rst_i is held for 1 clock or more; then comes a flush. From the reset to the flush all groups are cleared, so
//              what is left of a row that the reset cut does not run, and no winner is valid.
`include "slog_assert.svh"
module slog_dense_engine
  import slog_dense_pkg::*;
#(
    parameter  int unsigned Offsets   = 128,
    parameter  int unsigned Lanes     = 8,
    parameter  int unsigned MaxWindow = 32,
    parameter  int unsigned Sizes     = 3,
    parameter  int unsigned MaxWidth  = 640,
    localparam int unsigned ShrinkW   = (Sizes > 1) ? $clog2(Sizes) : 1,
    localparam int unsigned Flush     = 3 * Offsets + MaxWindow + 8
) (
    input  logic                    clk_i,
    input  logic                    rst_i,
    input  logic                    flush_i,
    input  logic    [  ShrinkW-1:0] shrink_i,
    input  logic    [  IndexBits:0] offsets_i,
    input  logic                    left_valid_i,    // a pixel of a row of the left plane
    input  logic                    first_i,
    input  logic                    left_incoming_i,
    input  logic                    left_leaving_i,
    input  logic    [          1:0] left_ok_i,
    input  logic                    right_valid_i,
    input  logic                    right_incoming_i,
    input  logic                    right_leaving_i,
    input  logic    [          1:0] right_ok_i,
    output logic                    winner_valid_o,
    output winner_t                 winner_o,
    output logic                    back_valid_o,
    output back_t                   back_o
);
  localparam int unsigned Groups = Offsets / Lanes;
  localparam int unsigned OkLag  = 4;  // the ok bits follow the others through the lanes
  localparam int unsigned OutLag = 5;  // and the winners follow the pixels

  // [n]: n + 1 columns ago; left incoming, left leaving, right incoming, right leaving.
  logic [MaxWindow:0][3:0] ago_q;
  logic left_valid_q, first_q, right_valid_q;
  logic [OkLag:0][1:0] left_ok_q, right_ok_q;
  logic [3:0] ago;
  logic flush_in_q;          // flush_i and shrink_i come from afar
  logic [ShrinkW-1:0] shrink_q;
  logic [Groups-1:0] flush_q;
  logic [Groups-1:0] calm_q;  // !flush_q, for the next group: the users of flush_q lie around its own
  logic held_q;  // a reset came, and no flush since
  logic [Offsets-1:0] used_q;
  logic [Groups-1:0][IndexBits:0] offsets_q;  // of each group, one after another; they change in a flush

  always_ff @(posedge clk_i) begin
    ago_q <= {ago_q[MaxWindow-1:0], {left_incoming_i && left_valid_i, left_leaving_i && left_valid_i,
                                     right_incoming_i && right_valid_i, right_leaving_i && right_valid_i}};
    first_q    <= first_i;
    left_ok_q  <= {left_ok_q[OkLag-1:0], left_ok_i & {2{left_valid_i}}};
    right_ok_q <= {right_ok_q[OkLag-1:0], right_ok_i & {2{right_valid_i}}};
    for (int unsigned k = 0; k < Offsets; k++) used_q[k] <= k < 32'(offsets_q[k/Lanes]);
    offsets_q <= $bits(offsets_q)'({offsets_q, offsets_i});
    shrink_q  <= shrink_i;
    if (rst_i) begin
      flush_in_q    <= 1'b0;
      left_valid_q  <= 1'b0;
      right_valid_q <= 1'b0;
      flush_q       <= '1;
      calm_q        <= '0;
      held_q        <= 1'b1;
    end else begin
      flush_in_q    <= flush_i;
      flush_q       <= ~Groups'({calm_q, !(flush_in_q || held_q)});
      calm_q        <= Groups'({calm_q, !(flush_in_q || held_q)});
      held_q        <= held_q && !flush_in_q;
      left_valid_q  <= left_valid_i;
      right_valid_q <= right_valid_i;
    end
  end

  always_comb begin
    ago = ago_q[MaxWindow];
    for (int unsigned s = 1; s < Sizes; s++) if (32'(shrink_q) == s) ago = ago_q[MaxWindow>>s];
  end

  left_t left[Groups+1];
  right_t right[Groups+1];
  logic [Groups:0][1:0] left_ok, right_ok;
  winner_t winner[Groups+1];
  back_t back[Groups+1];

  assign left[0] = '{in_row: left_valid_q, first: first_q,
                     bits: '{incoming: ago_q[0][3], leaving: ago_q[0][2], incoming_ago: ago[3], leaving_ago: ago[2]}};
  assign right[0] = '{in_row: right_valid_q,
                      bits: '{incoming: ago_q[0][1], leaving: ago_q[0][0], incoming_ago: ago[1], leaving_ago: ago[0]}};
  assign left_ok[0]  = left_ok_q[OkLag];
  assign right_ok[0] = right_ok_q[OkLag];
  assign winner[0]   = NoWinner;
  assign back[0]     = NoBack;

  for (genvar g = 0; g < Groups; g++) begin : g_group
    slog_dense_group #(
        .Lanes    (Lanes),
        .MaxWindow(MaxWindow),
        .MaxWidth (MaxWidth)
    ) u_group (
        .clk_i,
        .rst_i,
        .clear_i   (flush_q[g]),
        .base_i    (IndexBits'(g * Lanes)),
        .used_i    (used_q[g*Lanes+:Lanes]),
        .left_i    (left[g]),
        .right_i   (right[g]),
        .left_ok_i (left_ok[g]),
        .right_ok_i(right_ok[g]),
        .winner_i  (winner[g]),
        .back_i    (back[g]),
        .left_o    (left[g+1]),
        .right_o   (right[g+1]),
        .left_ok_o (left_ok[g+1]),
        .right_ok_o(right_ok[g+1]),
        .winner_o  (winner[g+1]),
        .back_o    (back[g+1])
    );
  end

  logic [OutLag-1:0] winner_valid_q, back_valid_q;
  always_ff @(posedge clk_i) begin
    if (rst_i || flush_q[Groups-1]) begin
      winner_valid_q <= '0;
      back_valid_q   <= '0;
    end else begin
      winner_valid_q <= {winner_valid_q[OutLag-2:0], left[Groups].in_row};
      back_valid_q   <= {back_valid_q[OutLag-2:0], right[Groups].in_row};
    end
  end
  assign winner_valid_o = winner_valid_q[OutLag-1];
  assign winner_o       = winner[Groups];
  assign back_valid_o   = back_valid_q[OutLag-1];
  assign back_o         = back[Groups];

  `SLOG_ASSERT_INIT(SlogDenseEngineSizes, Groups >= 1 && Groups * Lanes == Offsets && Offsets <= 2 ** IndexBits &&
                    Sizes >= 1 && MaxWindow >> (Sizes - 1) >= 2 && MaxWindow % (1 << (Sizes - 1)) == 0)
`ifndef SYNTHESIS
  logic [15:0] flushed_q;  // clocks that the flush lasts, up to Flush
  always_ff @(posedge clk_i) flushed_q <= rst_i || !flush_i ? '0 : flushed_q + 16'(32'(flushed_q) < Flush);
`endif
  `SLOG_ASSERT(SlogDenseEngineWholeFlush, flush_i || flushed_q == '0 || 32'(flushed_q) == Flush)
  `SLOG_ASSERT(SlogDenseEngineCalm, calm_q == ~flush_q)
  `SLOG_ASSERT(SlogDenseEngineHeld, !held_q || flush_q == '1)
  `SLOG_ASSERT(SlogDenseEngineFlush, !(flush_i || flush_in_q || held_q) || !(left_valid_i || right_valid_i))
endmodule : slog_dense_engine
