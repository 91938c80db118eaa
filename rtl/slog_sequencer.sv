// Turns tickets into steps of the array: one job after the other, rows of offsets one ahead of the walker.
//
// For each ticket: prepare (3 clocks), context to the peak unit, then, if accepted, the mask, then row after row: grant
// of the peak unit, operands loaded, row to slog_walker. A refused job only passes its context on.
//
//   steps   = wide ? height : ceil(height / 2)              wide = width > GroupBits
//   passes  = ceil((offsets_x - 1) / Pitch), at least 1: Pitch offsets each, 1..Pitch+1 in the last
//   gap     = offsets of the pass before - steps, at least 0: idle clocks, as lanes leave one a clock
// Latency    : row_ready_i to the first step_o 4 clocks (no gap, operands there, walker idle).
// Throughput : one step a clock from job to job of equal width, if a row takes 4 clocks or more and grants come at once.
//              A job of another width waits until the array has drained (DrainClocks), as mask_o is for all lanes alike.
// Rules      : contexts, grants and rows are in job order; a grant is asked for when the walker has taken the row before.
//              mask_o: {group B, group A}, 1 = the bit belongs to the window; static while a step is on its way.
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

  typedef enum logic [2:0] {Idle, Prepare, Context, Mask, Rows} state_e;
  state_e state_q;
  // The template's and the search's place no longer matter, and the row counter is as wide as the largest board's.
  /* verilator lint_off UNUSEDSIGNAL */
  ticket_t t_q;
  /* verilator lint_on UNUSEDSIGNAL */

  // Prepare: three stages that settle while state_q is Prepare.
  logic [1:0] prep_q;
  logic wide_q, single_q, same_width_q;
  logic [9:0] across_q;              // offsets_x - 2, or 0
  logic [7:0] steps_q;
  logic [4:0] last_chunk_q;
  logic [5:0] last_lanes_q, gap_first_q, gap_pass_q, gap_row_q;
  logic [7:0] mask_width_q;          // width mask_o is made for; 0 = none
  function automatic logic [5:0] gap(logic [5:0] lanes, logic [7:0] steps);
    return (8'(lanes) > steps) ? lanes - steps[5:0] : '0;
  endfunction
  always_ff @(posedge clk_i) begin
    if (state_q == Prepare) begin
      wide_q       <= t_q.job.width > 8'(GroupBits);
      single_q     <= t_q.job.offsets_x == 10'd1;
      across_q     <= (t_q.job.offsets_x[9:1] == '0) ? '0 : t_q.job.offsets_x - 10'd2;
      same_width_q <= t_q.job.width == mask_width_q;
      steps_q      <= wide_q ? t_q.job.height : (t_q.job.height >> 1) + 8'(t_q.job.height[0]);
      last_chunk_q <= 5'(across_q[9:PitchW]);
      last_lanes_q <= single_q ? 6'd1 : 6'(across_q[PitchW-1:0]) + 6'd2;
      gap_first_q  <= gap(6'(Pitch + 1), steps_q);
      gap_pass_q   <= gap(6'(Pitch), steps_q);
      gap_row_q    <= gap(last_lanes_q, steps_q);
    end
  end

  // Mask: units of MaskUnit bits are full, empty or partly full.
  localparam int unsigned UnitW    = (GroupBits < 8) ? $clog2(GroupBits) : 3;
  localparam int unsigned Unit     = 1 << UnitW;
  localparam int unsigned Units    = 2 * GroupBits / Unit;
  localparam int unsigned HalfUnit = GroupBits / Unit;
  logic [Units-1:0] full_q, partly_q;
  logic [Unit-1:0] part_q;
  logic [2*GroupBits-1:0] mask_q;
  logic mask_load;
  always_ff @(posedge clk_i) begin
    if (state_q == Prepare) begin
      for (int unsigned u = 0; u < Units; u++) begin
        // In a paired step group B is a row of its own.
        full_q[u]   <= t_q.job.width[7:UnitW] > (8-UnitW)'((wide_q || u < HalfUnit) ? u : u - HalfUnit);
        partly_q[u] <= t_q.job.width[7:UnitW] == (8-UnitW)'((wide_q || u < HalfUnit) ? u : u - HalfUnit);
      end
      for (int unsigned b = 0; b < Unit; b++) part_q[b] <= t_q.job.width[UnitW-1:0] > UnitW'(b);
    end
    if (mask_load) begin
      for (int unsigned b = 0; b < 2 * GroupBits; b++) begin
        mask_q[b] <= full_q[b/Unit] || (partly_q[b/Unit] && part_q[b%Unit]);
      end
    end
  end

  // Rows.
  logic [RowW-1:0] top_q, need_q, ahead_q;  // ring rows: window top; rows that must be there; how many more are there
  logic [9:0] down_q;                       // rows of offsets still to come, less one
  logic ctx_valid_q, row_valid_q, granted_q, begun_q;
  logic token_valid_q, token_ready, token;
  row_t token_q;
  logic drained, walking;
  assign mask_load = state_q == Mask && !same_width_q && drained && !token_valid_q;
  assign token     = granted_q && !ahead_q[RowW-1] && tpl_done_i[t_q.bank];

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      state_q       <= Idle;
      prep_q        <= '0;
      ctx_valid_q   <= 1'b0;
      row_valid_q   <= 1'b0;
      granted_q     <= 1'b0;
      token_valid_q <= 1'b0;
      mask_width_q  <= '0;
    end else begin
      if (token_ready) token_valid_q <= 1'b0;
      unique case (state_q)
        Idle: begin
          prep_q <= '0;
          if (ticket_valid_i) state_q <= Prepare;
        end
        Prepare: begin
          prep_q <= prep_q + 1'b1;
          if (prep_q == 2'd2) begin
            state_q     <= Context;
            ctx_valid_q <= 1'b1;
          end
        end
        Context:
        if (ctx_ready_i) begin
          ctx_valid_q <= 1'b0;
          state_q     <= (t_q.status == StatusOk) ? Mask : Idle;
        end
        Mask:
        if (same_width_q || mask_load) begin
          mask_width_q <= t_q.job.width;
          state_q      <= Rows;
        end
        Rows: begin
          if (!row_valid_q && !granted_q && !token_valid_q) row_valid_q <= 1'b1;
          if (row_valid_q && row_ready_i) begin
            row_valid_q <= 1'b0;
            granted_q   <= 1'b1;
          end
          if (token) begin
            granted_q     <= 1'b0;
            token_valid_q <= 1'b1;
            if (down_q == '0) state_q <= Idle;
          end
        end
        default: state_q <= Idle;
      endcase
    end
  end

  always_ff @(posedge clk_i) begin
    if (state_q == Idle) t_q <= ticket_i;
    if (state_q == Prepare) begin
      top_q   <= t_q.row[RowW-1:0];
      need_q  <= t_q.row[RowW-1:0] + RowW'(t_q.job.height);
      down_q  <= t_q.job.offsets_y - 1'b1;
      begun_q <= 1'b0;
    end else if (token) begin
      top_q   <= top_q + 1'b1;
      need_q  <= need_q + 1'b1;
      down_q  <= down_q - 1'b1;
      begun_q <= 1'b1;
    end
    if (state_q == Rows) ahead_q <= rows_written_i - need_q;
    if (token) begin
      token_q <= '{
          final_row: down_q == '0,
          bank: t_q.bank,
          wide: wide_q,
          odd: t_q.job.height[0],
          last_step: 7'(steps_q - 1'b1),
          ring_row: 8'(top_q[RowW-2:0]),
          last_chunk: last_chunk_q,
          last_lanes: last_lanes_q,
          gap_row: begun_q ? gap_row_q : gap_first_q,
          gap_pass: gap_pass_q,
          free_to: (down_q == '0) ? 9'(need_q) : 9'(RowW'(top_q + 1'b1))
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

  assign ticket_ready_o = state_q == Idle;
  assign ctx_valid_o    = ctx_valid_q;
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
  assign mask_o         = mask_q;
  assign busy_o         = state_q != Idle || token_valid_q || walking;

  `SLOG_ASSERT_INIT(SlogSequencerPitch, Pitch == 2 ** PitchW && Pitch <= 32)
  `SLOG_ASSERT_STABLE(SlogSequencerCtxStable, ctx_valid_o, ctx_ready_i, ctx_o)
  `SLOG_ASSERT_STABLE(SlogSequencerRowStable, row_valid_o, row_ready_i, row_offsets_o)
  `SLOG_ASSERT(SlogSequencerMaskStatic, !$stable(mask_o) |-> !walking)
endmodule : slog_sequencer
