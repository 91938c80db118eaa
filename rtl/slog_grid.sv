// Lays a grid of jobs from one: job (i, j) is the given one moved by (i * step_x, j * step_y), tag counted up.
//
// Template and search move together. Jobs leave in raster order, i fastest.
// Latency    : the first job is offered one clock after the command is taken.
// Throughput : one job per clock; one clock between commands.
// Formats    : a count of 0 is taken as 1. Tags wrap; positions stop at 1023, which is outside every image, so that a grid
//              that runs off is refused rather than wrapped.
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
  logic valid_q;
  job_t job_q;
  logic [9:0] tpl_x_q, search_x_q;          // of the grid's first column
  logic [9:0] step_x_q, step_y_q, count_x_q;
  logic [9:0] after_x_q, after_y_q;         // jobs after this one in its row, rows after this one
  logic load, next, row_ends;

  assign job_ready_o = !valid_q;
  assign job_valid_o = valid_q;
  assign job_o       = job_q;
  assign load        = job_valid_i && !valid_q;
  assign next        = valid_q && job_ready_i;
  assign row_ends    = after_x_q == '0;

  function automatic logic [9:0] moved(logic [9:0] position, logic [9:0] step);
    logic [10:0] sum = 11'(position) + 11'(step);
    return sum[9:0] | {10{sum[10]}};
  endfunction

  // Jobs after the first of `count`.
  function automatic logic [9:0] after_first(logic [9:0] count);
    return (count == '0) ? '0 : count - 10'd1;
  endfunction

  always_ff @(posedge clk_i) begin
    if (rst_i) valid_q <= 1'b0;
    else if (load) valid_q <= 1'b1;
    else if (next && row_ends && after_y_q == '0) valid_q <= 1'b0;
  end

  always_ff @(posedge clk_i) begin
    if (load) begin
      job_q      <= job_i;
      tpl_x_q    <= job_i.tpl_x;
      search_x_q <= job_i.search_x;
      step_x_q   <= step_x_i;
      step_y_q   <= step_y_i;
      count_x_q  <= after_first(count_x_i);
      after_x_q  <= after_first(count_x_i);
      after_y_q  <= after_first(count_y_i);
    end else if (next) begin
      job_q.tag <= job_q.tag + 16'd1;
      if (row_ends) begin
        job_q.tpl_x    <= tpl_x_q;
        job_q.search_x <= search_x_q;
        job_q.tpl_y    <= moved(job_q.tpl_y, step_y_q);
        job_q.search_y <= moved(job_q.search_y, step_y_q);
        after_x_q      <= count_x_q;
        after_y_q      <= after_y_q - 10'd1;
      end else begin
        job_q.tpl_x    <= moved(job_q.tpl_x, step_x_q);
        job_q.search_x <= moved(job_q.search_x, step_x_q);
        after_x_q      <= after_x_q - 10'd1;
      end
    end
  end

  `SLOG_ASSERT_STABLE(SlogGridOutStable, job_valid_o, job_ready_i, job_o)
endmodule : slog_grid
