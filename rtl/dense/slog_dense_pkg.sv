// SPDX-License-Identifier: Apache-2.0
// Types of the dense engine, which scores a window around every pixel for every offset of a row.
package slog_dense_pkg;
  localparam int unsigned SumBits   = 11;  // 0..1024 mismatches of a window of 32x32, and Absent
  localparam int unsigned IndexBits = 8;   // number of an offset

  typedef logic [SumBits-1:0] sum_t;
  localparam sum_t Absent = '1;  // no offset counts there: worse than any sum

  // One plane's bits for a column: of the row that comes in, of the row that leaves, and both a window's width ago.
  typedef struct packed {
    logic incoming;
    logic leaving;
    logic incoming_ago;
    logic leaving_ago;
  } bits_t;

  // What moves along the lanes with a pixel of the left plane, and with one of the right plane.
  typedef struct packed {
    logic  in_row;
    logic  first;   // in_row: the pixel is of a pass' first row
    bits_t bits;
  } left_t;
  typedef struct packed {
    logic  in_row;
    bits_t bits;
  } right_t;

  // The best of the offsets so far, and what is needed to go on.
  typedef struct packed {
    logic                 fresh;    // it is the offset before the next
    logic [IndexBits-1:0] index;
    sum_t                 best;
    sum_t                 lower;    // of the offset before it
    sum_t                 upper;    // of the offset after it
    sum_t                 rest;     // least of all others
    sum_t                 earlier;  // least of all but the offset before the next
    sum_t                 last;     // of the offset before the next
  } winner_t;
  localparam winner_t NoWinner = '{fresh: 1'b0, index: '0, default: Absent};

  // The best of a right pixel's offsets so far.
  typedef struct packed {
    logic [IndexBits-1:0] index;
    sum_t                 best;
  } back_t;
  localparam back_t NoBack = '{index: '0, best: Absent};
endpackage : slog_dense_pkg
