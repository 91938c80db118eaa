// SPDX-License-Identifier: Apache-2.0
// Types of the dense engine, which scores a window around every pixel for every offset of a row, and of the block around it.
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

  // A pass through two planes in the store: golden/dense_job.py says what it computes. Lengths in pixels.
  typedef struct packed {
    logic [2:0]         left_slot;
    logic [2:0]         right_slot;
    logic [5:0]         window;
    logic [8:0]         offsets;
    logic signed [9:0]  start;      // how far to the left offset 0 lies in the right plane
    logic signed [9:0]  down;       // rows that the right plane lies above
    logic [7:0]         step_x;     // every how manyth column and row has a word in the map
    logic [7:0]         step_y;
    sum_t               most;       // valid: best is at most this,
    sum_t               margin;     // rest exceeds it by this at least,
    logic               check;      // and the right plane's own winner agrees
    logic               live;       // the slots may be those of captures under way: each row waits for theirs
  } dense_job_t;

  // Outcome of a pass: Ok, or the first reason for refusal in this order, or ended early. Where it is DenseOk, the map is that
  // of the frames that the slots hold.
  typedef enum logic [2:0] {
    DenseOk         = 3'd0,
    DenseBadWindow  = 3'd1,  // not a built size, or larger than the image in a direction
    DenseBadOffsets = 3'd2,  // none, or more than built
    DenseBadSlot    = 3'd3,  // slot not on this board, or without a frame and, in a live pass, a request for one
    DenseBadStep    = 3'd4,  // a step of 0
    DenseCancelled  = 3'd5,  // the map ended early, or a frame of a live pass was not whole when the pass ended
    DenseLost       = 3'd6   // a frame of a live pass did not become whole: the map is not to be used
  } dense_status_e;

  // A word of the map: one pixel. Sums as in winner_t, Absent among them.
  typedef struct packed {
    logic [8:0]           zero;
    logic                 valid;   // found, and within the job's limits
    logic                 agrees;  // left and right plane's winners are one offset apart at most
    logic                 found;   // an offset counts here; index is 0 otherwise
    logic [IndexBits-1:0] index;
    sum_t                 best;
    sum_t                 lower;
    sum_t                 upper;
    sum_t                 rest;
  } map_t;

  // What slog_dense_plan makes of a job. Addresses are of store words, modulo the address width of the board.
  typedef struct packed {
    logic [2:0]  shrink;       // window is MaxWindow >> shrink
    logic [9:0]  mask;         // -window: n >= window exactly where n & mask is not 0
    logic [15:0] left;         // word that the left plane's row 0 begins with
    logic [15:0] right;        // word that the right plane's row -down begins with, from column on
    logic [15:0] above;        // words from a row to that a window's height above it
    logic [10:0] pitch;        // clocks from row to row
    logic [9:0]  left_delay;   // clocks by which the left row waits for the right one, or the right one for it
    logic [9:0]  right_delay;
    logic [9:0]  column;       // of the right plane, where its rows begin: the first of a word
    logic [9:0]  skip;         // columns from there that no left pixel meets
    logic [9:0]  count;        // columns from there to the last that one meets
    logic        meets;        // any does
    logic [9:0]  words;        // of the map in one row
  } plan_t;

  // What one plane's row needs to be sent: slog_dense_stream.
  typedef struct packed {
    logic [15:0] incoming;       // words of its first column: in the row that comes into the windows,
    logic [15:0] leaving;        // and in the one that leaves them
    logic        has_incoming;   // the row lies in the plane; where it does not, its bits are 0
    logic        has_leaving;
    logic [9:0]  column;         // of the row's first bit, the first of a word
    logic [9:0]  skip;           // columns that are not sent
    logic [9:0]  count;          // columns with them
    logic [1:0]  ok;             // left_ok_i or right_ok_i of slog_dense_engine, where the window lies in the row
    logic        first;
  } row_t;

  // The winner of a left pixel with what the right plane says of it.
  typedef struct packed {
    logic                 found;
    logic                 agrees;
    logic [IndexBits-1:0] index;
    sum_t                 best;
    sum_t                 lower;
    sum_t                 upper;
    sum_t                 rest;
  } checked_t;
endpackage : slog_dense_pkg
