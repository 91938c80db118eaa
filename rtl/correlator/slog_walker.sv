// SPDX-License-Identifier: Apache-2.0
// Steps through one row of offsets: the passes along the row, and in each pass the steps down the window.
//
//   pass c scores offsets c*Pitch .. c*Pitch + lanes - 1
//   step s reads ring rows ring_row + 2s, ring_row + 2s + 1 (paired), or ring_row + s (wide)
//
// Latency    : row_valid_i && row_ready_o to the first step_o 3 clocks plus gap_row; rows_freed_o changes and
//              bank_free_o is asserted in the clock of a last step.
// Throughput : one step per clock, without a gap between rows if the next row is offered in time. Gaps before passes
//              (gap_row, gap_pass) keep the ends of two passes apart by at least the offsets of the earlier one.
// Rules      : a row that is offered stays offered until it is taken. After its last step its ring rows are freed, and,
//              if it is the job's last row, the template bank. drained_o: no row is offered or in work, and no step was
//              valid for at least DrainClocks clocks.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_walker
  import slog_pkg::*, slog_fetch_pkg::*;
#(
    parameter  int unsigned Pitch       = 32,
    parameter  int unsigned RingRows    = 256,
    parameter  int unsigned DrainClocks = 45,
    localparam int unsigned RowW        = $clog2(RingRows) + 1
) (
    input  logic            clk_i,
    input  logic            rst_i,
    input  logic            row_valid_i,
    output logic            row_ready_o,
    input  row_t            row_i,
    output step_t           step_o,
    output logic [RowW-1:0] rows_freed_o,
    output logic            bank_free_o,  // pulse
    output logic            busy_o,
    output logic            drained_o
);
  localparam int unsigned RingW  = RowW - 1;
  localparam int unsigned DrainW = $clog2(DrainClocks) + 1;

  // The row counter has the width of the largest board's.
  /* verilator lint_off UNUSEDSIGNAL */
  row_t row_q;
  /* verilator lint_on UNUSEDSIGNAL */
  logic active_q;
  // Each flag has an inverted copy for the counters (waiting_q, more_q, again_q): all 0 when no row is loaded, as at
  // the end of a row.
  logic stepping_q, waiting_q;  // not in a gap
  logic last_q, more_q;         // the next step is the last of its pass
  logic last_pass_q, again_q;   // this pass is the last of its row
  logic paired_q;               // !row_q.wide
  logic [6:0] gap_q, gap_next;
  logic [7:0] steps_q, steps_next;
  logic [5:0] passes_q, passes_next;
  logic [RingW-1:0] ring_q;
  logic go, pass_end, reload, row_end, stepping, last, last_pass, waiting, more, again;

  assign go          = active_q && !waiting_q;
  assign pass_end    = stepping_q && last_q;
  assign reload      = !waiting_q && (!active_q || last_q);
  assign row_end     = active_q && pass_end && last_pass_q;
  assign row_ready_o = !active_q || (pass_end && last_pass_q);
  assign gap_next    = gap_q - 1'b1;
  assign steps_next  = steps_q - 1'b1;
  assign passes_next = passes_q - 1'b1;

  // Each flag is the next sign bit of its counter. While no row is active, row_i is loaded, valid or not.
  always_comb begin
    stepping  = stepping_q || gap_next[6];
    last      = stepping_q ? steps_next[7] : last_q;
    last_pass = last_pass_q;
    if (pass_end) begin
      stepping  = row_q.gap_pass[6];
      last      = row_q.steps[7];
      last_pass = passes_next[5];
    end
    waiting = !stepping;
    more    = !last;
    again   = !last_pass;
    if (row_ready_o) begin
      stepping  = row_i.gap_row[6];
      last      = row_i.steps[7];
      last_pass = row_i.passes[5];
      waiting   = row_valid_i && !row_i.gap_row[6];
      more      = row_valid_i && !row_i.steps[7];
      again     = row_valid_i && !row_i.passes[5];
    end
  end
  always_ff @(posedge clk_i) begin
    stepping_q  <= stepping;
    last_q      <= last;
    last_pass_q <= last_pass;
    if (rst_i) begin
      active_q  <= 1'b0;
      waiting_q <= 1'b0;
      more_q    <= 1'b0;
      again_q   <= 1'b0;
    end else begin
      active_q  <= row_valid_i || !row_ready_o;
      waiting_q <= waiting;
      more_q    <= more;
      again_q   <= again;
    end
  end
  always_ff @(posedge clk_i) begin
    if (!waiting_q && !more_q && !again_q) begin
      row_q    <= row_i;
      paired_q <= !row_i.wide;
    end
    if (reload) passes_q <= again_q ? passes_next : row_i.passes;
    if (!waiting_q) begin
      steps_q <= more_q ? steps_next : again_q ? row_q.steps : row_i.steps;
      ring_q  <= more_q ? ring_q + RingW'({paired_q, row_q.wide}) :
                 again_q ? row_q.ring_row[RingW-1:0] : row_i.ring_row[RingW-1:0];
    end
    gap_q <= waiting_q ? gap_next : again_q ? row_q.gap_pass : row_i.gap_row;
  end

  // The step is assembled in two clocks: first from the flags and the row, then with the counters of the second stage.
  step_t made_q, step_q;
  logic valid_q, valid_q2, passed_q, first_pass_q, ended_q, final_q, bank_free_q, drained_q;
  logic count_q;                // the step counters advance or restart
  logic first_q;
  logic [6:0] tpl_step_q;
  logic [4:0] chunk_q;
  logic [RowW-1:0] free_to_q, freed_q;
  logic [DrainW-1:0] drain_q;  // clocks until drained_o, less two: negative at the end
  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      valid_q     <= 1'b0;
      valid_q2    <= 1'b0;
      ended_q     <= 1'b0;
      bank_free_q <= 1'b0;
      freed_q     <= '0;
      drain_q     <= DrainW'(DrainClocks - 1);
      drained_q   <= 1'b0;
    end else begin
      valid_q     <= go;
      valid_q2    <= valid_q;
      ended_q     <= row_end;
      bank_free_q <= ended_q && final_q;
      if (ended_q) freed_q <= free_to_q;
      if (valid_q2) drain_q <= DrainW'(DrainClocks - 2);
      else if (!drain_q[DrainW-1]) drain_q <= drain_q - 1'b1;
      drained_q <= !active_q && !row_valid_i && !valid_q && !valid_q2 && drain_q[DrainW-1];
    end
  end
  always_ff @(posedge clk_i) begin
    passed_q     <= reload;
    first_pass_q <= reload && !again_q;
    if (first_pass_q) chunk_q <= '0;
    else if (passed_q) chunk_q <= chunk_q + 1'b1;
    free_to_q  <= row_q.free_to[RowW-1:0];
    final_q    <= row_q.final_row;
    count_q    <= !waiting_q;
    if (made_q.last) begin
      first_q    <= 1'b1;
      tpl_step_q <= '0;
    end else if (count_q) begin
      first_q    <= 1'b0;
      tpl_step_q <= tpl_step_q + 1'b1;
    end
    made_q <= '{
        valid: 1'b1,
        first: 1'b0,
        last: !more_q,
        wide: row_q.wide,
        row_b: row_q.wide || more_q || !row_q.odd,
        bank: row_q.bank,
        tpl_step: '0,
        ring_row: 8'(ring_q),
        chunk: '0,
        lanes: again_q ? 6'(Pitch) : row_q.last_lanes
    };
    step_q          <= made_q;
    step_q.first    <= first_q;
    step_q.tpl_step <= tpl_step_q;
    step_q.chunk    <= chunk_q;
  end

  always_comb begin
    step_o       = step_q;
    step_o.valid = valid_q2;
  end
  assign rows_freed_o = freed_q;
  assign bank_free_o  = bank_free_q;
  assign busy_o       = active_q || valid_q || valid_q2;
  assign drained_o    = drained_q;

  `SLOG_ASSERT(SlogWalkerCopies, {waiting_q, more_q, again_q} == ({3{active_q}} & ~{stepping_q, last_q, last_pass_q}))
  `SLOG_ASSERT_INIT(SlogWalkerPitch, Pitch <= 62)
  `SLOG_ASSERT_INIT(SlogWalkerRing, RingRows == 2 ** RingW && RingRows <= 256)
  `SLOG_ASSERT_STABLE(SlogWalkerRowStable, row_valid_i, row_ready_o, row_i)
  `SLOG_ASSERT(SlogWalkerLanes, !row_valid_i || (row_i.last_lanes != '0 && 32'(row_i.last_lanes) <= Pitch + 1))
  `SLOG_PAST(past_rst, rst_i)
  `SLOG_PAST(past_freed, rows_freed_o)
  `SLOG_ASSERT(SlogWalkerFreed, past_rst || (rows_freed_o == past_freed && !bank_free_o)
                               || (step_o.valid && step_o.last))
`ifndef SYNTHESIS
  int unsigned clocks_since_step;
  always_ff @(posedge clk_i) begin
    if (rst_i || step_o.valid) clocks_since_step <= 0;
    else if (clocks_since_step < DrainClocks) clocks_since_step <= clocks_since_step + 1;
  end
`endif
  `SLOG_ASSERT(SlogWalkerDrained, !drained_o || (!busy_o && !step_o.valid && clocks_since_step >= DrainClocks))
endmodule : slog_walker
