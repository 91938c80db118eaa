// SPDX-License-Identifier: Apache-2.0
// Unrolls a job's context into its rows of offsets. A refused job has one row.
//
// Handshake  : row_coming_o: a row can be taken in the next clock, unless one is taken in this clock. row_taken_i takes
//              it; row_o, refused_o and scoring_o are stable for one clock more.
// Latency    : a context taken in clock t may have its first row taken in clock t+1.
// Throughput : one row in two clocks, jobs back to back.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_peak_rows
  import slog_pkg::*;
  import slog_peak_pkg::*;
(
    input  logic     clk_i,
    input  logic     rst_i,
    input  logic     ctx_valid_i,
    output logic     ctx_ready_o,
    input  context_t ctx_i,
    output logic     row_coming_o,
    input  logic     row_taken_i,
    output row_t     row_o,
    output logic     refused_o,    // row_o.status is not StatusOk
    output scoring_t scoring_o
);
  logic load_q, step_q;  // no row is held: the context is loaded; a row was taken and the job has more
  logic some_q, load;    // some_q: !load_q, a copy, because load_q enables all of the data
  row_t row_q;
  scoring_t scoring_q;
  logic refused_q;
  logic [9:0] left_q;  // rows after this one

  assign load         = (row_taken_i && row_q.last) || (!some_q && !ctx_valid_i);
  assign ctx_ready_o  = !some_q;
  assign row_coming_o = ctx_valid_i || some_q;
  assign row_o        = row_q;
  assign refused_o    = refused_q;
  assign scoring_o    = scoring_q;

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      load_q <= 1'b1;
      some_q <= 1'b0;
      step_q <= 1'b0;
    end else begin
      load_q <= load;
      some_q <= !load;
      step_q <= row_taken_i && !row_q.last;
    end
  end

  always_ff @(posedge clk_i) begin
    if (load_q) begin
      refused_q    <= ctx_i.status != StatusOk;
      row_q.tag    <= ctx_i.tag;
      row_q.status <= ctx_i.status;
      row_q.last_x <= ctx_i.offsets_x - 10'd1;
      row_q.y      <= '0;
      row_q.first  <= 1'b1;
      left_q       <= ctx_i.offsets_y - 10'd1;
      scoring_q    <= '{surface: ctx_i.surface, one: ctx_i.offsets_x == 10'd1, two: ctx_i.offsets_x == 10'd2,
                        area: ctx_i.area};
    end else if (step_q) begin
      row_q.y     <= row_q.y + 10'd1;
      row_q.first <= 1'b0;
      left_q      <= left_q - 10'd1;
    end
    if (!some_q) row_q.last <= ctx_i.status != StatusOk || ctx_i.offsets_y == 10'd1;
    else if (step_q) row_q.last <= left_q == 10'd1;
  end

  `SLOG_ASSERT(SlogPeakRowsRefused, load_q || refused_q == (row_q.status != StatusOk))
  `SLOG_ASSERT(SlogPeakRowsThere, !row_taken_i || !(load_q || step_q))
  `SLOG_ASSERT(SlogPeakRowsCopies, some_q == !load_q)
  `SLOG_ASSERT_KEPT(SlogPeakRowsStay, row_taken_i, {row_o, refused_o, scoring_o})
endmodule : slog_peak_rows
