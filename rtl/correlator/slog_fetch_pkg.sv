// SPDX-License-Identifier: Apache-2.0
// Types between the fetch unit, the sequencer and its walker. Widths are those of the largest board.
package slog_fetch_pkg;
  import slog_pkg::*;

  // Location of a rectangle of bits in the store, and the alignment of its rows.
  typedef struct packed {
    logic [15:0] addr;       // store word that holds the first row's first bit
    logic [5:0]  shift;      // position of that bit in its word
    logic [3:0]  words_in;   // store words that a row touches, less one
    logic [3:0]  words_out;  // aligned words that a row fills, less one
    logic [9:0]  rows;       // rows, less one
  } load_t;

  // A checked job, as passed to the sequencer. Its operands may still be loading.
  typedef struct packed {
    job_t              job;
    status_e           status;
    logic              bank;  // template bank
    logic [8:0]        row;   // ring row counter of the first search row
    logic [ScoreW-1:0] area;  // width * height
  } ticket_t;

  // One row of offsets for the walker. Values that are counted down are stored so that their sign bit marks the end:
  // no comparison is needed.
  typedef struct packed {
    logic       final_row;   // last row of its job
    logic       bank;
    logic       wide;
    logic       odd;         // odd height: if paired, group B is empty in the last step
    logic [7:0] steps;       // steps of a pass, less two: negative when there is one
    logic [7:0] ring_row;    // ring row of the window's top
    logic [5:0] passes;      // passes, less two: negative when there is one
    logic [5:0] last_lanes;  // offsets of the last pass
    logic [6:0] gap_row;     // idle clocks before the first pass, less one: negative when there is none
    logic [6:0] gap_pass;    // idle clocks before each later pass, less one: negative when there is none
    logic [8:0] free_to;     // ring row counter up to which ring rows are free after this row of offsets
  } row_t;
endpackage : slog_fetch_pkg
