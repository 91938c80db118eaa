// SPDX-License-Identifier: Apache-2.0
// Checks whether a job can be executed, and computes the area of its window.
//
//   status = the first that applies of BadWindow, NoOffsets, BadSlot, Outside (slog_pkg::status_e), else Ok
//   area   = width * height, by shift and add
//
//   clock  registers (after start_i in clock 0)
//   1      width and height; offset and slot tests; right and bottom of the template, extent of the search
//   2      window tests; template against the image; right and bottom of the search; no_offsets, bad_slot
//   3      search against the image; bad_window
//   4      outside
//   5      status_o
//   9      area_o
// Latency    : done_o 9 clocks after start_i; status_o and area_o stay until the next start_i.
// Refusal    : status_o is not Ok; slog_fetch then issues the job's ticket with this status and loads nothing.
// Throughput : one job at a time. job_i is stable from start_i to done_o; slot_valid_i is sampled in start_i's clock.
// Formats    : area_o modulo 2**15: exact for every window a board accepts (up to 128x128).
// Reset      : rst_i is held for 1 clock or more.
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
    // The tag is not used here.
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
  logic busy_q, done_q, first_q;  // first_q: the clock after start_i
  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      busy_q <= 1'b0;
      done_q <= 1'b0;
    end else begin
      done_q <= busy_q && step_q == StepW'(Latency - 1);
      if (start_i) busy_q <= 1'b1;
      else if (step_q == StepW'(Latency - 1)) busy_q <= 1'b0;
    end
    step_q  <= start_i ? StepW'(1) : step_q + 1'b1;
    first_q <= start_i;
  end

  function automatic logic bad_size(logic [7:0] size);
    return size < 8'(MinWindow) || size > 8'(MaxWindow);
  endfunction
  // Only the sign of a - b is used.
  function automatic logic less(logic [11:0] a, logic [11:0] b);
    /* verilator lint_off UNUSEDSIGNAL */
    logic [12:0] difference = 13'(a) - 13'(b);
    /* verilator lint_on UNUSEDSIGNAL */
    return difference[12];
  endfunction
  logic [7:0] good_slots;
  assign good_slots = slot_valid_i & 8'((1 << Slots) - 1);

  logic bad_width_q, bad_height_q, none_across_q, none_down_q;
  logic [1:0] good_tpl_q, good_search_q;                       // [n]: the slot is good if its bit 2 is n
  logic [10:0] tpl_right_q, tpl_bottom_q, span_x_q, span_y_q;  // column, row after the template; search size plus one
  logic [10:0] limit_x_q, limit_y_q;                           // image size plus one
  logic [11:0] right_q, bottom_q;                              // column, row after the search, plus one
  logic tpl_out_q, tpl_below_q, out_q, below_q, outside_q, bad_window_q, no_offsets_q, bad_slot_q;
  status_e status_q;
  logic [7:0] factor_q, width_q;                               // the height, its highest bit first; the width
  logic [ScoreW-1:0] area_q;
  always_ff @(posedge clk_i) begin
    // Registers that depend on job_i only are valid from the clock after start_i on and need no enable.
    width_q       <= job_i.width;
    factor_q      <= busy_q ? factor_q << 1 : job_i.height;
    none_across_q <= job_i.offsets_x == '0;
    none_down_q   <= job_i.offsets_y == '0;
    tpl_right_q   <= 11'(job_i.tpl_x) + 11'(job_i.width);
    tpl_bottom_q  <= 11'(job_i.tpl_y) + 11'(job_i.height);
    span_x_q      <= 11'(job_i.offsets_x) + 11'(job_i.width);
    span_y_q      <= 11'(job_i.offsets_y) + 11'(job_i.height);
    if (start_i) begin
      for (int unsigned n = 0; n < 2; n++) begin
        good_tpl_q[n]    <= good_slots[{1'(n), job_i.tpl_slot[1:0]}];
        good_search_q[n] <= good_slots[{1'(n), job_i.search_slot[1:0]}];
      end
      limit_x_q <= 11'(image_width_i) + 1'b1;
      limit_y_q <= 11'(image_height_i) + 1'b1;
    end
    if (first_q) begin
      bad_width_q  <= bad_size(width_q);
      bad_height_q <= bad_size(factor_q);
    end
    if (busy_q) begin
      area_q      <= (first_q ? '0 : area_q << 1) + (factor_q[7] ? ScoreW'(width_q) : '0);
      tpl_out_q   <= !less(12'(tpl_right_q), 12'(limit_x_q));
      tpl_below_q <= !less(12'(tpl_bottom_q), 12'(limit_y_q));
      right_q     <= 12'(job_i.search_x) + 12'(span_x_q);
      bottom_q    <= 12'(job_i.search_y) + 12'(span_y_q);
      out_q       <= less(12'(limit_x_q), right_q);
      below_q     <= less(12'(limit_y_q), bottom_q);
      bad_window_q <= bad_width_q || bad_height_q;
      no_offsets_q <= none_across_q || none_down_q;
      bad_slot_q   <= !good_tpl_q[job_i.tpl_slot[2]] || !good_search_q[job_i.search_slot[2]];
      outside_q    <= tpl_out_q || tpl_below_q || out_q || below_q;
      // Priority encoder, one gate per bit.
      status_q <= status_e'({!bad_window_q && !no_offsets_q && !bad_slot_q && outside_q,
                             !bad_window_q && (no_offsets_q || bad_slot_q),
                             bad_window_q || (!no_offsets_q && bad_slot_q)});
    end
  end

  assign done_o   = done_q;
  assign status_o = status_q;
  assign area_o   = area_q;

  `SLOG_ASSERT_INIT(SlogJobCheckCodes, StatusOk == 0 && StatusBadWindow == 1 && StatusNoOffsets == 2
                                       && StatusBadSlot == 3 && StatusOutside == 4)
  `SLOG_ASSERT(SlogJobCheckOneAtATime, !(start_i && busy_q))
  `SLOG_PAST(past_job, job_i)
  `SLOG_ASSERT(SlogJobCheckStable, !busy_q || job_i == past_job)
  `SLOG_ASSERT_INIT(SlogJobCheckRanges, MinWindow >= 1 && MinWindow <= MaxWindow && MaxWindow ** 2 < 2 ** ScoreW
                                        && Slots >= 1 && Slots <= 8)
  `SLOG_ASSERT_KEPT(SlogJobCheckKept, !busy_q && !start_i, {status_o, area_o})
endmodule : slog_job_check
