// SPDX-License-Identifier: Apache-2.0
// Turns tickets into steps of the array: one job after the other, preparing the next row of offsets while slog_walker
// steps through the present one.
//
// For each ticket: prepare (4 clocks); pass the context to the peak unit; then, if the job is accepted, load the mask,
// and for every row wait for the peak unit's grant and for the operands, then pass the row to slog_walker. Of a refused
// job only the context is passed on.
//
//   steps   = wide ? height : ceil(height / 2)              wide = width > GroupBits
//   passes  = ceil((offsets_x - 1) / Pitch), at least 1: Pitch offsets each, 1..Pitch+1 in the last
//   gap     = offsets of the pass before - steps, at least 0: idle clocks, because lanes output one score per clock
// Latency    : row_ready_i to the first step_o 5 clocks (no gap, operands loaded, walker idle).
// Throughput : one step per clock from row to row, if a row takes 4 clocks or more and grants are immediate; also from
//              job to job of equal width, if the last rows take 8. A job of another width waits until the array has
//              drained (DrainClocks), because all lanes use the same mask_o.
// Rules      : contexts, grants and rows are in job order; a grant is requested after the walker has taken the row
//              before. Ring rows are freed only after they were written. mask_o: {group B, group A}, 1 = the bit
//              belongs to the window; static while a step is in flight; changes 6 clocks after the array has drained.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_sequencer
  import slog_pkg::*, slog_fetch_pkg::*;
#(
    parameter  int unsigned GroupBits   = 64,
    parameter  int unsigned Pitch       = 32,
    parameter  int unsigned RingRows    = 256,
    parameter  int unsigned DrainClocks = 45,
    localparam int unsigned RowW        = $clog2(RingRows) + 1
) (
    input  logic                   clk_i,
    input  logic                   rst_i,
    input  logic                   ticket_valid_i,
    output logic                   ticket_ready_o,
    input  ticket_t                ticket_i,
    input  logic [1:0]             tpl_done_i,
    input  logic [RowW-1:0]        rows_written_i,
    output logic [RowW-1:0]        rows_freed_o,
    output logic                   bank_free_o,
    output logic                   ctx_valid_o,
    input  logic                   ctx_ready_i,
    output context_t               ctx_o,
    output logic                   row_valid_o,
    input  logic                   row_ready_i,
    output logic [9:0]             row_offsets_o,
    output step_t                  step_o,
    output logic [2*GroupBits-1:0] mask_o,
    output logic                   busy_o
);
  localparam int unsigned PitchW = $clog2(Pitch);
  localparam int unsigned GroupW = $clog2(GroupBits);

  // One-hot state.
  logic idle_q, prepare_q, context_q, masking_q, rows_q;
  // The positions of template and search are not used here, and the row counter has the width of the largest board's.
  /* verilator lint_off UNUSEDSIGNAL */
  ticket_t t_q;
  /* verilator lint_on UNUSEDSIGNAL */

  // Prepare: four stages after t_q, which holds the ticket. They have no enable, because it would be a long net.
  logic [2:0] prep_q;
  logic wide_q, single_q, same_width_q, good_q;
  logic [7:0] paired_steps_q;
  logic [1:0] tail_q;                // width mod GroupBits: any bit set in its upper, its lower half
  logic [9:0] across_q;              // offsets_x - 2, unless single
  logic [7:0] steps_q, more_steps_q;
  logic [4:0] last_chunk_q;
  logic [5:0] more_passes_q, last_lanes_q;
  logic [6:0] gap_first_q, gap_pass_q, gap_row_q;
  logic [7:0] mask_width_q;          // width for which mask_o is valid; 0 = none
  logic [2:0] mask_wide_q;           // [k]: wide_q of that width, k clocks later
  // The gap less one; if there is none the sign bit is set and the other bits are arbitrary.
  function automatic logic [6:0] gap(logic [5:0] lanes, logic [7:0] steps);
    /* verilator lint_off UNUSEDSIGNAL */
    logic [8:0] less_one = 9'(lanes) + {1'b1, ~steps};
    /* verilator lint_on UNUSEDSIGNAL */
    return {less_one[8], less_one[5:0]};
  endfunction
  always_ff @(posedge clk_i) begin
    if (prepare_q) same_width_q <= t_q.job.width == mask_width_q;
    tail_q         <= {t_q.job.width[GroupW-1:GroupW/2] != '0, t_q.job.width[GroupW/2-1:0] != '0};
    single_q       <= t_q.job.offsets_x == 10'd1;
    across_q       <= t_q.job.offsets_x - 10'd2;
    good_q         <= t_q.status == StatusOk;
    paired_steps_q <= (t_q.job.height >> 1) + 8'(t_q.job.height[0]);
    wide_q         <= t_q.job.width[7:GroupW+1] != '0 || (t_q.job.width[GroupW] && tail_q != '0);
    last_chunk_q   <= single_q ? '0 : 5'(across_q[9:PitchW]);
    last_lanes_q   <= single_q ? 6'd1 : 6'(across_q[PitchW-1:0]) + 6'd2;
    steps_q        <= wide_q ? t_q.job.height : paired_steps_q;
    more_passes_q  <= 6'(last_chunk_q) - 6'd1;
    more_steps_q   <= steps_q - 8'd2;
    gap_first_q    <= gap(6'(Pitch + 1), steps_q);
    gap_pass_q     <= gap(6'(Pitch), steps_q);
    gap_row_q      <= gap(last_lanes_q, steps_q);
  end

  // Mask: units of Unit bits are full, empty or partly full. It is computed from mask_width_q without enables, which
  // would be nets across the whole array.
  localparam int unsigned UnitW    = (GroupBits < 8) ? $clog2(GroupBits) : 3;
  localparam int unsigned Unit     = 1 << UnitW;
  localparam int unsigned Units    = 2 * GroupBits / Unit;
  localparam int unsigned HalfUnit = GroupBits / Unit;
  localparam int unsigned CountW   = 8 - UnitW;
  // The number of full units in two parts, its low two bits and the bits above them: [n]: the part is above n, equal to n.
  logic [3:0] past_low_q, in_low_q;
  logic [(1<<CountW)/4-1:0] past_high_q, in_high_q;
  logic [Units-1:0] reached_q, ends_q;  // [u]: a row over both groups reaches past unit u, ends in it
  logic [Units-1:0] full_q, partly_q;
  logic [Unit-1:0] part_q, part_q2, part_q3;
  logic [2*GroupBits-1:0] mask_q, mask_q2;  // mask_q2: pipeline register for the distance to the array
  logic mask_load;
  always_ff @(posedge clk_i) begin
    for (int unsigned n = 0; n < 4; n++) begin
      past_low_q[n] <= mask_width_q[UnitW+:2] > 2'(n);
      in_low_q[n]   <= mask_width_q[UnitW+:2] == 2'(n);
    end
    for (int unsigned n = 0; n < (1 << CountW) / 4; n++) begin
      past_high_q[n] <= mask_width_q[7:UnitW+2] > (CountW - 2)'(n);
      in_high_q[n]   <= mask_width_q[7:UnitW+2] == (CountW - 2)'(n);
    end
    for (int unsigned u = 0; u < Units; u++) begin
      reached_q[u] <= past_high_q[u/4] || (in_high_q[u/4] && past_low_q[u%4]);
      ends_q[u]    <= in_high_q[u/4] && in_low_q[u%4];
      // In a paired step group B holds another row, with the same mask as group A.
      full_q[u]   <= (mask_wide_q[2] || u < HalfUnit) ? reached_q[u] : reached_q[u-HalfUnit];
      partly_q[u] <= (mask_wide_q[2] || u < HalfUnit) ? ends_q[u] : ends_q[u-HalfUnit];
    end
    for (int unsigned b = 0; b < Unit; b++) part_q[b] <= mask_width_q[UnitW-1:0] > UnitW'(b);
    part_q2 <= part_q;
    part_q3 <= part_q2;
    for (int unsigned b = 0; b < 2 * GroupBits; b++) begin
      mask_q[b] <= full_q[b/Unit] || (partly_q[b/Unit] && part_q3[b%Unit]);
    end
    mask_q2          <= mask_q;
    mask_wide_q[2:1] <= mask_wide_q[1:0];
    if (mask_load) mask_wide_q[0] <= wide_q;
  end

  // Rows of offsets.
  logic [RowW-2:0] top_q;                   // ring row of the window's top
  logic [RowW-1:0] top_next_q, need_q;      // ring row counters: of the row below; required value of rows_written_i
  logic [10:0] down_q, down_next;           // rows of offsets after the next one, less one: negative when there is none
  logic final_q;                            // the next row is the last
  logic [RowW-1:0] ahead;                   // ring rows written beyond those required: negative when some are missing
  logic there_q;                            // the next row's operands are loaded
  logic row_valid_q, granted_q, begun_q;
  logic turn_q;                             // prep_q[0] || took_q
  logic token_valid_q, token_ready, token, took_q, done_q;
  row_t token_q;
  logic drained, walking;
  assign mask_load = masking_q && !same_width_q && drained && !token_valid_q;
  assign token     = granted_q && there_q;
  assign down_next = down_q - 1'b1;
  assign ahead     = rows_written_i - need_q;

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      idle_q        <= 1'b1;
      prepare_q     <= 1'b0;
      context_q     <= 1'b0;
      masking_q     <= 1'b0;
      rows_q        <= 1'b0;
      prep_q        <= '0;
      mask_width_q  <= '0;
      row_valid_q   <= 1'b0;
      granted_q     <= 1'b0;
      took_q        <= 1'b0;
      turn_q        <= 1'b0;
      done_q        <= 1'b0;
      token_valid_q <= 1'b0;
    end else begin
      idle_q        <= (idle_q && !ticket_valid_i) || (context_q && ctx_ready_i && !good_q) || done_q;
      prepare_q     <= (idle_q && ticket_valid_i) || (prepare_q && !prep_q[2]);
      context_q     <= (prepare_q && prep_q[2]) || (context_q && !ctx_ready_i);
      masking_q     <= (context_q && ctx_ready_i && good_q) || (masking_q && !same_width_q && !mask_load);
      rows_q        <= (masking_q && (same_width_q || mask_load)) || (rows_q && !done_q);
      prep_q        <= {prep_q[1:0], prepare_q && prep_q == '0};
      if (mask_load) mask_width_q <= t_q.job.width;
      row_valid_q   <= row_valid_q ? !row_ready_i : rows_q && !granted_q && !token_valid_q;
      granted_q     <= (row_valid_q && row_ready_i) || (granted_q && !token);
      took_q        <= token;
      turn_q        <= token || (prepare_q && prep_q == '0);
      done_q        <= token && final_q;
      token_valid_q <= token || (token_valid_q && !token_ready);
    end
  end

  always_ff @(posedge clk_i) begin
    if (idle_q) t_q <= ticket_i;
    if (turn_q) begin
      top_q      <= took_q ? top_next_q[RowW-2:0] : t_q.row[RowW-2:0];
      top_next_q <= took_q ? top_next_q + 1'b1 : t_q.row[RowW-1:0] + 1'b1;
      need_q     <= took_q ? need_q + 1'b1 : t_q.row[RowW-1:0] + RowW'(t_q.job.height);
      down_q     <= took_q ? down_next : 11'(t_q.job.offsets_y) - 11'd2;
      begun_q    <= took_q;
    end
    if (prep_q[1] || took_q) final_q <= took_q ? down_next[10] : down_q[10];
    if (rows_q) there_q <= !ahead[RowW-1] && tpl_done_i[t_q.bank];
    if (granted_q) begin
      token_q <= '{
          final_row: final_q,
          bank: t_q.bank,
          wide: wide_q,
          odd: t_q.job.height[0],
          steps: more_steps_q,
          ring_row: 8'(top_q),
          passes: more_passes_q,
          last_lanes: last_lanes_q,
          gap_row: begun_q ? gap_row_q : gap_first_q,
          gap_pass: gap_pass_q,
          free_to: final_q ? 9'(need_q) : 9'(top_next_q)
      };
    end
  end

  slog_walker #(
      .Pitch      (Pitch),
      .RingRows   (RingRows),
      .DrainClocks(DrainClocks)
  ) u_walker (
      .clk_i,
      .rst_i,
      .row_valid_i(token_valid_q),
      .row_ready_o(token_ready),
      .row_i      (token_q),
      .step_o,
      .rows_freed_o,
      .bank_free_o,
      .busy_o     (walking),
      .drained_o  (drained)
  );

  assign ticket_ready_o = idle_q;
  assign ctx_valid_o    = context_q;
  assign ctx_o          = '{
          tag: t_q.job.tag,
          surface: t_q.job.surface,
          status: t_q.status,
          offsets_x: t_q.job.offsets_x,
          offsets_y: t_q.job.offsets_y,
          area: t_q.area
      };
  assign row_valid_o    = row_valid_q;
  assign row_offsets_o  = t_q.job.offsets_x;
  assign mask_o         = mask_q2;
  assign busy_o         = !idle_q || token_valid_q || walking;

  `SLOG_ASSERT(SlogSequencerState, $onehot({idle_q, prepare_q, context_q, masking_q, rows_q}))
  `SLOG_ASSERT(SlogSequencerTurn, turn_q == (prep_q[0] || took_q))
  `SLOG_ASSERT_INIT(SlogSequencerPitch, Pitch == 2 ** PitchW && Pitch <= 32)
  `SLOG_ASSERT_STABLE(SlogSequencerCtxStable, ctx_valid_o, ctx_ready_i, ctx_o)
  `SLOG_ASSERT_STABLE(SlogSequencerRowStable, row_valid_o, row_ready_i, row_offsets_o)
  `SLOG_PAST(past_mask, mask_o)
  `SLOG_ASSERT(SlogSequencerMaskStatic, mask_o == past_mask || !step_o.valid)
  `SLOG_ASSERT_INIT(SlogSequencerSizes, GroupBits == 2 * Pitch && GroupBits >= 4 && RingRows == 2 ** (RowW - 1)
                                        && RingRows <= 256)
  `SLOG_ASSERT(SlogSequencerGrantOrder, !row_valid_o || !token_valid_q)
  `SLOG_ASSERT(SlogSequencerFreed, RowW'(rows_written_i - rows_freed_o) <= RowW'(RingRows))
endmodule : slog_sequencer
