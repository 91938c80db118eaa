// Steps through one row of offsets: pass after pass along the row, step after step down the window.
//
//   pass c scores offsets c*Pitch .. c*Pitch + lanes - 1; step s reads ring rows ring_row + 2s, + 2s + 1 (paired) or + s (wide)
//
// Latency    : row_valid_i && row_ready_o to the first step_o 2 clocks plus gap_row.
// Throughput : a step a clock; from row to row no clock is lost when the next row is offered in time. Gaps before passes
//              (gap_row, gap_pass) keep the ends of two passes at least as many clocks apart as the earlier one has offsets.
// Rules      : a row's ring rows, and after the job's last row its template bank, are free with its last step.
//              drained_o: nothing to do, and no valid step for at least DrainClocks clocks.
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
  localparam int unsigned DrainW = $clog2(DrainClocks + 2);

  // The row counter is as wide as the largest board's.
  /* verilator lint_off UNUSEDSIGNAL */
  row_t row_q;
  /* verilator lint_on UNUSEDSIGNAL */
  logic active_q;
  logic wait_q;             // gap_q is not yet zero
  logic [5:0] gap_q;
  logic first_q, last_q;    // the next step is the first, the last of its pass
  logic last_pass_q;
  logic [6:0] step_q, left_q;
  logic [4:0] chunk_q;
  logic [RingW-1:0] ring_q;
  logic go, pass_end, row_end, take;

  assign go          = active_q && !wait_q;
  assign pass_end    = go && last_q;
  assign row_end     = pass_end && last_pass_q;
  assign row_ready_o = !active_q || row_end;
  assign take        = row_valid_i && row_ready_o;

  always_ff @(posedge clk_i) begin
    if (rst_i) active_q <= 1'b0;
    else active_q <= take || (active_q && !row_end);
  end

  // The last step's flag is made one step ahead.
  always_ff @(posedge clk_i) begin
    if (take) begin
      row_q       <= row_i;
      chunk_q     <= '0;
      last_pass_q <= row_i.last_chunk == '0;
      gap_q       <= row_i.gap_row;
      wait_q      <= row_i.gap_row != '0;
      step_q      <= '0;
      left_q      <= row_i.last_step;
      first_q     <= 1'b1;
      last_q      <= row_i.last_step == '0;
      ring_q      <= row_i.ring_row[RingW-1:0];
    end else if (pass_end) begin
      chunk_q     <= chunk_q + 1'b1;
      last_pass_q <= chunk_q + 1'b1 == row_q.last_chunk;
      gap_q       <= row_q.gap_pass;
      wait_q      <= row_q.gap_pass != '0;
      step_q      <= '0;
      left_q      <= row_q.last_step;
      first_q     <= 1'b1;
      last_q      <= row_q.last_step == '0;
      ring_q      <= row_q.ring_row[RingW-1:0];
    end else if (go) begin
      step_q  <= step_q + 1'b1;
      left_q  <= left_q - 1'b1;
      first_q <= 1'b0;
      last_q  <= left_q == 7'd1;
      ring_q  <= ring_q + (row_q.wide ? RingW'(1) : RingW'(2));
    end else if (active_q) begin
      gap_q  <= gap_q - 1'b1;
      wait_q <= gap_q != 6'd1;
    end
  end

  step_t step_out_q;
  logic valid_q, bank_free_q;
  logic [RowW-1:0] freed_q;
  logic [DrainW-1:0] drain_q;
  logic drained_q;
  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      valid_q     <= 1'b0;
      bank_free_q <= 1'b0;
      freed_q     <= '0;
      drain_q     <= DrainW'(DrainClocks);
      drained_q   <= 1'b0;
    end else begin
      valid_q     <= go;
      bank_free_q <= row_end && row_q.final_row;
      if (row_end) freed_q <= row_q.free_to[RowW-1:0];
      if (go) drain_q <= DrainW'(DrainClocks);
      else if (drain_q != '0) drain_q <= drain_q - 1'b1;
      drained_q <= !active_q && !take && drain_q == '0;
    end
  end
  always_ff @(posedge clk_i) begin
    if (go) begin
      step_out_q <= '{
          valid: 1'b1,
          first: first_q,
          last: last_q,
          wide: row_q.wide,
          row_b: row_q.wide || !(last_q && row_q.odd),
          bank: row_q.bank,
          tpl_step: step_q,
          ring_row: 8'(ring_q),
          chunk: chunk_q,
          lanes: last_pass_q ? row_q.last_lanes : 6'(Pitch)
      };
    end
  end

  always_comb begin
    step_o       = step_out_q;
    step_o.valid = valid_q;
  end
  assign rows_freed_o = freed_q;
  assign bank_free_o  = bank_free_q;
  assign busy_o       = active_q || valid_q;
  assign drained_o    = drained_q;

  `SLOG_ASSERT_INIT(SlogWalkerPitch, Pitch <= 62)
endmodule : slog_walker
