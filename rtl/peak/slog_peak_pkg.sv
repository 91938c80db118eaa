// SPDX-License-Identifier: Apache-2.0
// Types that the parts of slog_peak pass to one another.
package slog_peak_pkg;
  import slog_pkg::*;

  // A score that may be absent: {present, score}. An absent score is 0, below every present one.
  typedef logic [ScoreW:0] maybe_t;

  // The score as it is coded in results: NoScore if absent.
  function automatic logic [ScoreW-1:0] or_no_score(maybe_t value);
    return value[ScoreW] ? value[ScoreW-1:0] : NoScore;
  endfunction

  // A row of offsets of a job. A refused job has one row, first and last, without scores.
  typedef struct packed {
    logic [15:0] tag;
    status_e     status;
    logic [9:0]  last_x;  // offsets across, minus 1
    logic [9:0]  y;
    logic        first;   // of its job
    logic        last;
  } row_t;

  // Data needed while the scores of a row arrive.
  typedef struct packed {
    logic              surface;
    logic              one;      // one offset across
    logic              two;      // two offsets across
    logic [ScoreW-1:0] area;
  } scoring_t;

  // Order to scan a row together with the rows above and below it. Only a row that holds the best so far is read; any
  // other row is scanned as one absent column.
  typedef struct packed {
    logic       fresh;   // the row holds the best so far
    logic       last;    // of its job
    logic       above;   // which of the three rows exist; these are read if fresh is set
    logic       middle;
    logic       below;
    logic       only;    // one column, whatever the value of last_x
    logic       brief;   // one or two columns
    logic [9:0] last_x;
    logic [9:0] best_x;
  } scan_t;

  // The part of a row's outcome that is known before its scan.
  typedef struct packed {
    logic        fresh;
    logic        last;
    maybe_t      other;   // candidate for runner-up that needs no scan
    logic [15:0] tag;
    status_e     status;
    logic [9:0]  best_x;  // best so far, this row included
    logic [9:0]  best_y;
    maybe_t      score;
  } outcome_t;

  // A result without its neighbours.
  typedef struct packed {
    logic [15:0]       tag;
    status_e           status;
    logic [9:0]        best_x;
    logic [9:0]        best_y;
    logic [ScoreW-1:0] score;
    logic [ScoreW-1:0] runner_up;
  } verdict_t;
endpackage : slog_peak_pkg
