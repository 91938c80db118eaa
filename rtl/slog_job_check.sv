// Decides whether a job can be done, and the area of its window.
//
//   status = the first that holds of BadWindow, NoOffsets, BadSlot, Outside (slog_pkg::status_e), else Ok
//   area   = width * height, by shift and add
//
//   clock  registers (after start_i in clock 0)
//   1      window, offset and slot tests; right and bottom of the template, extent of the search
//   2      template against the image; right and bottom of the search
//   3      search against the image
//   4      status_o
//   9      area_o
// Latency    : done_o 9 clocks after start_i; status_o and area_o stay until the next start_i.
// Throughput : one job at a time. job_i is stable from start_i to done_o; slot_valid_i is looked at in start_i's clock.
// Formats    : area_o modulo 2**15: exact for every window a board accepts (up to 128x128).
`include "slog_assert.svh"
module slog_job_check
  import slog_pkg::*;
#(
    parameter  int unsigned MinWindow = 8,
    parameter  int unsigned MaxWindow = 128,
    parameter  int unsigned Slots     = 6,
    localparam int unsigned Latency   = 9
) (
    input  logic              clk_i,
    input  logic              rst_i,
    input  logic              start_i,
    // The tag does not matter here.
    /* verilator lint_off UNUSEDSIGNAL */
    input  job_t              job_i,
    /* verilator lint_on UNUSEDSIGNAL */
    input  logic [9:0]        image_width_i,
    input  logic [9:0]        image_height_i,
    input  logic [7:0]        slot_valid_i,
    output logic              done_o,
    output status_e           status_o,
    output logic [ScoreW-1:0] area_o
);
  localparam int unsigned StepW = $clog2(Latency);

  logic [StepW-1:0] step_q;  // clocks since start_i
  logic busy_q, done_q;
  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      busy_q <= 1'b0;
      done_q <= 1'b0;
    end else begin
      done_q <= busy_q && step_q == StepW'(Latency - 1);
      if (start_i) busy_q <= 1'b1;
      else if (step_q == StepW'(Latency - 1)) busy_q <= 1'b0;
    end
    step_q <= start_i ? StepW'(1) : step_q + 1'b1;
  end

  function automatic logic bad_size(logic [7:0] size);
    return size < 8'(MinWindow) || size > 8'(MaxWindow);
  endfunction
  function automatic logic good_slot(logic [2:0] slot, logic [7:0] valid);
    return {1'b0, slot} < 4'(Slots) && valid[slot];
  endfunction

  logic bad_window_q, no_offsets_q, bad_slot_q;
  logic [10:0] tpl_right_q, tpl_bottom_q, span_x_q, span_y_q;  // first column or row past; extent plus one
  logic [10:0] limit_x_q, limit_y_q;                           // image size plus one
  logic [11:0] right_q, bottom_q;                              // first column or row past the search, plus one
  logic tpl_out_q, tpl_below_q, out_q, below_q;
  status_e status_q;
  always_ff @(posedge clk_i) begin
    if (start_i) begin
      bad_window_q <= bad_size(job_i.width) || bad_size(job_i.height);
      no_offsets_q <= job_i.offsets_x == '0 || job_i.offsets_y == '0;
      bad_slot_q   <= !good_slot(job_i.tpl_slot, slot_valid_i) || !good_slot(job_i.search_slot, slot_valid_i);
      tpl_right_q  <= 11'(job_i.tpl_x) + 11'(job_i.width);
      tpl_bottom_q <= 11'(job_i.tpl_y) + 11'(job_i.height);
      span_x_q     <= 11'(job_i.offsets_x) + 11'(job_i.width);
      span_y_q     <= 11'(job_i.offsets_y) + 11'(job_i.height);
      limit_x_q    <= 11'(image_width_i) + 1'b1;
      limit_y_q    <= 11'(image_height_i) + 1'b1;
    end
    if (busy_q) begin
      tpl_out_q   <= tpl_right_q >= limit_x_q;
      tpl_below_q <= tpl_bottom_q >= limit_y_q;
      right_q     <= 12'(job_i.search_x) + 12'(span_x_q);
      bottom_q    <= 12'(job_i.search_y) + 12'(span_y_q);
      out_q       <= right_q > 12'(limit_x_q);
      below_q     <= bottom_q > 12'(limit_y_q);
      if (bad_window_q) status_q <= StatusBadWindow;
      else if (no_offsets_q) status_q <= StatusNoOffsets;
      else if (bad_slot_q) status_q <= StatusBadSlot;
      else if (tpl_out_q || tpl_below_q || out_q || below_q) status_q <= StatusOutside;
      else status_q <= StatusOk;
    end
  end

  logic [7:0] factor_q;
  logic [ScoreW-1:0] area_q;
  always_ff @(posedge clk_i) begin
    if (start_i) begin
      factor_q <= job_i.height;
      area_q   <= '0;
    end else if (busy_q) begin
      factor_q <= factor_q << 1;
      area_q   <= (area_q << 1) + (factor_q[7] ? ScoreW'(job_i.width) : '0);
    end
  end

  assign done_o   = done_q;
  assign status_o = status_q;
  assign area_o   = area_q;

  `SLOG_ASSERT(SlogJobCheckOneAtATime, !(start_i && busy_q))
  `SLOG_ASSERT(SlogJobCheckStable, busy_q |-> $stable(job_i))
endmodule : slog_job_check
