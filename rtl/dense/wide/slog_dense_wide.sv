// SPDX-License-Identifier: Apache-2.0
// Wide dense engine: a score for every pixel and every one of Offsets offsets, four pixels per clock; winners only.
//
//   M(x, y, k) = sum over i, j < Window of L(x-i, y-j) ^ R(x-start-k-i, y-down-j)
//
// The planes come in words of four columns, each with two rows: the one that comes into the windows and the one that
// leaves them, Window rows above. start and down are the feed's: they say which right columns come with the left ones.
// Where start is no multiple of 4, the right plane's rows begin within a word.
//
// Stage  registers                    valid after the clock of the word
//   1    left_valid_q first_q ago_q   1: the bits, and those of Window columns ago
//   2    slog_dense_wide_group        Offsets / 4 + 10, one group behind the other
//   3    winner_o winner_valid_o      Offsets / 4 + 11
// Latency    : as above.
// Throughput : four pixels per clock; nothing can stop it within a row.
// Formats    : see slog_dense_wide_pkg. Column 4t + j of the row is winner_o[j].
// Borders    : every column of a row's words has a winner; where no offset counts it is NoWideWinner. left_ok_i: columns
//              whose left window lies in its plane; right_ok_i likewise. left_odd_i and right_odd_i tell even rows from odd
//              ones: an offset counts where both are of one row, as the rows may overlap in time.
// Ties       : the first of equals.
// Rules      : rows as in slog_dense_wide_group; from a row to the next but one it is more clocks than words of a row and
//              groups together. A right row begins up to Offsets - 1 columns before the left one, or after it: the right
//              plane's word for offset 0 comes with the left one. Columns of a word beyond the row are 0; in the first
//              Window rows the leaving bits are 0, and so is each bit whose own row lies outside the plane. flush_i is held
//              before a pass for Flush clocks or more in which nothing is in a row, nor in the clock after them. A flush
//              begins 10 clocks after the last left word or later: the winners of words in the 9 clocks before it are lost.
// Reset      : rst_i is held for 1 clock or more; then comes a flush before the first row. What is left of a row that the
//              reset cut is dropped.
`include "slog_assert.svh"
module slog_dense_wide
  import slog_dense_wide_pkg::*;
#(
    parameter  int unsigned Offsets  = 128,
    parameter  int unsigned Window   = 32,
    parameter  int unsigned MaxWidth = 640,
    localparam int unsigned Flush    = Offsets / 2 + Window / 4 + 8
) (
    input  logic                       clk_i,
    input  logic                       rst_i,
    input  logic                       flush_i,
    input  logic                       left_valid_i,    // a word of a row of the left plane
    input  logic                       first_i,
    input  logic         [Columns-1:0] left_incoming_i,
    input  logic         [Columns-1:0] left_leaving_i,
    input  logic         [Columns-1:0] left_ok_i,
    input  logic                       left_odd_i,
    input  logic                       right_valid_i,
    input  logic         [Columns-1:0] right_incoming_i,
    input  logic         [Columns-1:0] right_leaving_i,
    input  logic         [Columns-1:0] right_ok_i,
    input  logic                       right_odd_i,
    output logic                       winner_valid_o,
    output wide_winner_t [Columns-1:0] winner_o
);
  import slog_dense_pkg::*;
  localparam int unsigned Groups = Offsets / Columns;
  localparam int unsigned Ago    = Window / Columns;
  localparam int unsigned OkLag  = 6;  // the ok bits follow the others through the groups
  localparam int unsigned OutLag = 10;  // and the winners follow the left words

  // [n]: n + 1 clocks ago; left incoming, left leaving, right incoming, right leaving.
  logic [Ago:0][3:0][Columns-1:0] ago_q;
  logic left_valid_q, first_q;
  wide_ok_t [OkLag:0] left_ok_q, right_ok_q;
  logic flush_in_q;            // flush_i comes from afar
  logic [Groups-1:0] flush_q;  // of each group, one after another

  always_ff @(posedge clk_i) begin
    ago_q      <= {ago_q[Ago-1:0], {{left_incoming_i, left_leaving_i} & {2 * Columns{left_valid_i}},
                                    {right_incoming_i, right_leaving_i} & {2 * Columns{right_valid_i}}}};
    first_q    <= first_i;
    left_ok_q  <= {left_ok_q[OkLag-1:0], {left_odd_i, left_ok_i & {Columns{left_valid_i}}}};
    right_ok_q <= {right_ok_q[OkLag-1:0], {right_odd_i, right_ok_i & {Columns{right_valid_i}}}};
    if (rst_i) begin
      left_valid_q <= 1'b0;
      flush_in_q   <= 1'b1;
      flush_q      <= '1;
    end else begin
      left_valid_q <= left_valid_i;
      flush_in_q   <= flush_i;
      flush_q      <= Groups'({flush_q, flush_in_q});
    end
  end

  logic [Groups:0] in_row, first;
  wide_bits_t left[Groups+1], right[Groups+1];
  wide_ok_t left_ok[Groups+1], right_ok[Groups+1];
  wide_winner_t [Columns-1:0] winner[Groups+1];

  assign in_row[0]   = left_valid_q;
  assign first[0]    = first_q;
  assign left[0]     = '{incoming: ago_q[0][3], leaving: ago_q[0][2],
                         incoming_ago: ago_q[Ago][3], leaving_ago: ago_q[Ago][2]};
  assign right[0]    = '{incoming: ago_q[0][1], leaving: ago_q[0][0],
                         incoming_ago: ago_q[Ago][1], leaving_ago: ago_q[Ago][0]};
  assign left_ok[0]  = left_ok_q[OkLag];
  assign right_ok[0] = right_ok_q[OkLag];
  assign winner[0]   = {Columns{NoWideWinner}};

  for (genvar g = 0; g < Groups; g++) begin : g_group
    slog_dense_wide_group #(
        .MaxWidth(MaxWidth)
    ) u_group (
        .clk_i,
        .rst_i,
        .clear_i   (flush_q[g]),
        .base_i    (GroupBits'(g)),
        .in_row_i  (in_row[g]),
        .first_i   (first[g]),
        .left_i    (left[g]),
        .right_i   (right[g]),
        .left_ok_i (left_ok[g]),
        .right_ok_i(right_ok[g]),
        .winner_i  (winner[g]),
        .in_row_o  (in_row[g+1]),
        .first_o   (first[g+1]),
        .left_o    (left[g+1]),
        .right_o   (right[g+1]),
        .left_ok_o (left_ok[g+1]),
        .right_ok_o(right_ok[g+1]),
        .winner_o  (winner[g+1])
    );
  end

  logic [OutLag-1:0] winner_valid_q;
  wide_winner_t [Columns-1:0] winner_q;
  always_ff @(posedge clk_i) begin
    for (int unsigned j = 0; j < Columns; j++)
      winner_q[j] <= winner[Groups][j].score.absent ? NoWideWinner : winner[Groups][j];
  end
  always_ff @(posedge clk_i) begin
    if (rst_i || flush_q[Groups-1]) winner_valid_q <= '0;
    else winner_valid_q <= {winner_valid_q[OutLag-2:0], in_row[Groups]};
  end
  assign winner_valid_o = winner_valid_q[OutLag-1];
  assign winner_o       = winner_q;

  `SLOG_ASSERT_INIT(SlogDenseWideSizes, Groups >= 1 && Groups * Columns == Offsets && Offsets <= 2 ** IndexBits &&
                    Ago >= 1 && Ago * Columns == Window && Window <= 32)
`ifndef SYNTHESIS
  localparam int unsigned MinWords = 4;
  // What the rules count: of the left plane, of the right one, since the flush.
  typedef struct packed {
    logic        odd;     // of the last word
    logic        began;   // there was one
    logic [15:0] ended;   // rows before that of the last word, up to Window
  } rows_t;
  rows_t left_rows_q, right_rows_q;
  logic [15:0] flushed_q;         // clocks that the flush lasts, up to Flush
  logic fresh_q;                  // a reset came, and no flush since
  logic past_first, past_right;
  logic [15:0] words_q;           // of the left row, as long as it lasts; of the last one after it
  logic [15:0] since_q, since2_q; // clocks from the first words of the last left row and of the one before it
  logic [OutLag-2:0] late_q;      // left words in the clocks before, of which a flush would drop the winners
  logic left_begins;
  assign left_begins = left_valid_i && !left_valid_q;

  function automatic rows_t after(rows_t rows, logic valid, logic odd);
    return '{odd: valid ? odd : rows.odd, began: valid || rows.began,
             ended: rows.ended + 16'(valid && rows.began && odd != rows.odd && 32'(rows.ended) < Window)};
  endfunction
  function automatic logic [15:0] later(logic [15:0] clocks);
    return clocks + 16'(clocks != '1);
  endfunction

  always_ff @(posedge clk_i) begin
    flushed_q    <= rst_i || !flush_i ? '0 : flushed_q + 16'(32'(flushed_q) < Flush);
    fresh_q      <= rst_i || (fresh_q && 32'(flushed_q) != Flush);
    left_rows_q  <= rst_i || flush_i ? '0 : after(left_rows_q, left_valid_i, left_odd_i);
    right_rows_q <= rst_i || flush_i ? '0 : after(right_rows_q, right_valid_i, right_odd_i);
    past_first   <= first_i;
    past_right   <= right_valid_i;
    words_q      <= rst_i || flush_i ? '0 : left_begins ? 16'd1 : words_q + 16'(left_valid_i);
    since_q      <= rst_i || flush_i ? '1 : left_begins ? 16'd1 : later(since_q);
    since2_q     <= rst_i || flush_i ? '1 : left_begins ? later(since_q) : later(since2_q);
    late_q       <= rst_i ? '0 : {late_q[OutLag-3:0], left_valid_i};
  end
`endif
  `SLOG_ASSERT(SlogDenseWideWholeFlush, flush_i || flushed_q == '0 || 32'(flushed_q) == Flush)
  `SLOG_ASSERT(SlogDenseWideFlush, !(flush_i || flush_in_q || fresh_q) || !(left_valid_i || right_valid_i))
  `SLOG_ASSERT(SlogDenseWideLate, !flush_i || late_q == '0)
  `SLOG_ASSERT(SlogDenseWideWords, !left_valid_q || left_valid_i || 32'(words_q) >= MinWords)
  // A row's words are of one parity, without a pause, and the next row's of the other: in the left plane after one.
  `SLOG_ASSERT(SlogDenseWideLeftRows, !left_valid_i || !left_rows_q.began ||
               (left_odd_i == left_rows_q.odd) == left_valid_q)
  `SLOG_ASSERT(SlogDenseWideRightRows, !right_valid_i || !right_rows_q.began ||
               past_right || right_odd_i != right_rows_q.odd)
  `SLOG_ASSERT(SlogDenseWideFirst, !left_begins || first_i == !left_rows_q.began)
  `SLOG_ASSERT(SlogDenseWideFirstStays, !(left_valid_i && left_valid_q) || first_i == past_first)
  `SLOG_ASSERT(SlogDenseWideLeaving,
               (!left_valid_i || left_leaving_i == '0 || 32'(after(left_rows_q, 1'b1, left_odd_i).ended) == Window) &&
               (!right_valid_i || right_leaving_i == '0 || 32'(after(right_rows_q, 1'b1, right_odd_i).ended) == Window))
  `SLOG_ASSERT(SlogDenseWideTwoRows, !left_begins || 32'(since2_q) > 32'(words_q) + Groups)
  for (genvar j = 0; j < Columns; j++) begin : g_column
    `SLOG_ASSERT(SlogDenseWideSum, !winner_valid_o || winner_q[j].score.absent ||
                 32'(winner_q[j].score.sum) <= Window * Window)
  end
endmodule : slog_dense_wide
