// SPDX-License-Identifier: Apache-2.0
// Types of the wide dense engine, which takes four columns of a row per clock: a word. Bit 0 is the leftmost column.
package slog_dense_wide_pkg;
  import slog_dense_pkg::*;

  localparam int unsigned Columns   = 4;   // of a word; as many offsets form a group
  localparam int unsigned GroupBits = IndexBits - $clog2(Columns);  // number of a group

  // One plane's bits of four columns: of the row that comes in, of the row that leaves, and both a window's width ago.
  typedef struct packed {
    logic [Columns-1:0] incoming;
    logic [Columns-1:0] leaving;
    logic [Columns-1:0] incoming_ago;
    logic [Columns-1:0] leaving_ago;
  } wide_bits_t;

  // Columns whose window lies in the plane; rows whose numbers are odd are told from even ones.
  typedef struct packed {
    logic               odd;
    logic [Columns-1:0] columns;
  } wide_ok_t;

  // The sums of one offset at a word: that of its last column, and by how much those of the columns before are less. So
  // a word of four sums is 34 bits instead of 44, and fits one block RAM of 36.
  typedef struct packed {
    sum_t              last;   // 0..1024
    logic signed [7:0] less0;  // -96..96
    logic signed [7:0] less1;  // -64..64
    logic signed [6:0] less2;  // -32..32
  } wide_sums_t;

  // A sum, and whether no offset counts there: then it is above all sums, whatever they are.
  typedef struct packed {
    logic absent;
    sum_t sum;
  } wide_score_t;

  // The best of the offsets so far.
  typedef struct packed {
    logic [IndexBits-1:0] index;
    wide_score_t          score;
  } wide_winner_t;
  localparam wide_winner_t NoWideWinner = '{index: '0, score: '{absent: 1'b1, sum: '0}};
endpackage : slog_dense_wide_pkg
