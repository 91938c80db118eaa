// SPDX-License-Identifier: Apache-2.0
// Makes a grid of jobs from one: job (i, j) is the given job moved by (i * step_x, j * step_y); the tag counts up.
//
// Template and search move together. Jobs are output in raster order, i fastest.
// Latency    : the first job leaves one clock after the command is taken, later ones when job_ready_i allows.
// Rules      : job_valid_o is asserted only if job_ready_i was high in the clock before; job_ready_i stays high until
//              a job has been transferred.
// Throughput : one job every other clock; one clock between commands.
// Formats    : a count of 0 is taken as 1. Tags wrap; positions saturate at 1023, outside every image, so that jobs
//              beyond the image are refused rather than wrapped.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_grid
  import slog_pkg::*;
(
    input  logic       clk_i,
    input  logic       rst_i,
    input  logic       job_valid_i,
    output logic       job_ready_o,
    input  job_t       job_i,
    input  logic [9:0] count_x_i,
    input  logic [9:0] count_y_i,
    input  logic [9:0] step_x_i,
    input  logic [9:0] step_y_i,
    output logic       job_valid_o,
    input  logic       job_ready_i,
    output job_t       job_o
);
  // States: ready_q (waiting for a command), valid_q (a job is in the output registers), neither (between two jobs).
  // laying_q is !ready_q and open_q is !valid_q: copies, to limit fan-out.
  logic ready_q, valid_q, laying_q, open_q;
  logic taken_q;  // the job in the output registers leaves in this clock; registered because the receiver is far
  // The command's job: its constant fields, and the positions of the first column.
  /* verilator lint_off UNUSEDSIGNAL */
  job_t job_q;
  /* verilator lint_on UNUSEDSIGNAL */
  logic [15:0] tag_q;
  logic [9:0] tpl_x_q, tpl_y_q, search_x_q, search_y_q;
  logic [9:0] step_x_q, step_y_q, count_x_q;
  logic [9:0] left_x_q;                     // jobs left in this row, this one included; unused in the last job
  logic [9:0] left_y_q;                     // rows left, this one included; unused in the last row
  logic last_x_q, last_y_q;                 // this job is the last of its row; this row is the last
  // The same for the next job, computed while valid_q is high; positions are not yet saturated.
  logic [10:0] tpl_x_q2, tpl_y_q2, search_x_q2, search_y_q2;
  logic [9:0] left_x_q2, left_y_q2;
  logic last_x_q2, last_y_q2;

  logic done;
  assign done = taken_q && last_x_q && last_y_q;

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      ready_q  <= 1'b1;
      laying_q <= 1'b0;
      valid_q  <= 1'b0;
      open_q   <= 1'b1;
      taken_q  <= 1'b0;
    end else begin
      ready_q  <= done || (ready_q && !job_valid_i);
      laying_q <= !(done || (ready_q && !job_valid_i));
      valid_q  <= !taken_q && (!ready_q || job_valid_i);
      open_q   <= taken_q || (ready_q && !job_valid_i);
      taken_q  <= !taken_q && (!ready_q || job_valid_i) && job_ready_i;
    end
  end

  function automatic logic [9:0] stopped(logic [10:0] position);
    return position[9:0] | {10{position[10]}};
  endfunction

  always_ff @(posedge clk_i) begin
    if (!laying_q) begin
      job_q     <= job_i;
      step_x_q  <= step_x_i;
      step_y_q  <= step_y_i;
      count_x_q <= count_x_i;
    end
    if (open_q) begin
      tag_q      <= laying_q ? tag_q + 1'b1 : job_i.tag;
      tpl_x_q    <= laying_q ? stopped(tpl_x_q2) : job_i.tpl_x;
      tpl_y_q    <= laying_q ? stopped(tpl_y_q2) : job_i.tpl_y;
      search_x_q <= laying_q ? stopped(search_x_q2) : job_i.search_x;
      search_y_q <= laying_q ? stopped(search_y_q2) : job_i.search_y;
      left_x_q   <= laying_q ? left_x_q2 : count_x_i;
      left_y_q   <= laying_q ? left_y_q2 : count_y_i;
      last_x_q   <= laying_q ? last_x_q2 : count_x_i[9:1] == '0;
      last_y_q   <= laying_q ? last_y_q2 : count_y_i[9:1] == '0;
    end else begin
      tpl_x_q2    <= last_x_q ? 11'(job_q.tpl_x) : 11'(tpl_x_q) + 11'(step_x_q);
      tpl_y_q2    <= last_x_q ? 11'(tpl_y_q) + 11'(step_y_q) : 11'(tpl_y_q);
      search_x_q2 <= last_x_q ? 11'(job_q.search_x) : 11'(search_x_q) + 11'(step_x_q);
      search_y_q2 <= last_x_q ? 11'(search_y_q) + 11'(step_y_q) : 11'(search_y_q);
      left_x_q2   <= last_x_q ? count_x_q : left_x_q - 1'b1;
      left_y_q2   <= left_y_q - 10'(last_x_q);
      last_x_q2   <= last_x_q ? count_x_q[9:1] == '0 : left_x_q == 10'd2;
      last_y_q2   <= last_y_q || (last_x_q && left_y_q == 10'd2);
    end
  end

  always_comb begin
    job_o          = job_q;
    job_o.tag      = tag_q;
    job_o.tpl_x    = tpl_x_q;
    job_o.tpl_y    = tpl_y_q;
    job_o.search_x = search_x_q;
    job_o.search_y = search_y_q;
  end
  assign job_ready_o = ready_q;
  assign job_valid_o = taken_q;

  `SLOG_ASSERT(SlogGridState, open_q == !valid_q && laying_q == !ready_q && !(ready_q && valid_q))
  `SLOG_ASSERT(SlogGridRoom, !taken_q || (valid_q && job_ready_i))
  `SLOG_ASSERT_NEXT(SlogGridJobsApart, job_valid_o, !job_valid_o)
  `SLOG_ASSERT_NEXT(SlogGridReadyStays, job_ready_i && !job_valid_o, job_ready_i)
endmodule : slog_grid
