// SPDX-License-Identifier: Apache-2.0
// The correlator: feeds operands from the store to the array, and the array's scores to the peak unit. Wiring only.
//
//   jobs -> slog_fetch -> slog_operands -> slog_array -> slog_peak -> results, surface
//                 \-> slog_sequencer -/                  /
//                              \---- contexts, grants --/
// Latency    : see the blocks.
// Throughput : one score per clock while a pass has no more steps than offsets.
// Counters   : busy_o is high from two clocks after a job is offered until two clocks after its last step; score_o is
//              high for one clock for every score, one clock after the score leaves the array.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_correlator
  import slog_pkg::*, slog_fetch_pkg::*;
#(
    parameter  int unsigned GroupBits    = 64,
    parameter  int unsigned Pitch        = 32,
    parameter  int unsigned Lanes        = 33,
    parameter  int unsigned ScoreBits    = 15,
    parameter  int unsigned MaxWidth     = 640,
    parameter  int unsigned MaxHeight    = 480,
    parameter  int unsigned WordsPerRow  = 10,
    parameter  int unsigned Slots        = 6,
    parameter  int unsigned MinWindow    = 8,
    parameter  int unsigned MaxWindow    = 128,
    parameter  int unsigned RingRows     = 256,
    parameter  int unsigned SurfaceDepth = 1024,
    parameter  int unsigned ResultDepth  = 64,
    localparam int unsigned AddrW        = $clog2(Slots * MaxHeight * WordsPerRow),
    localparam int unsigned ResultLevelW = $clog2(ResultDepth + 1)
) (
    input  logic                    clk_i,
    input  logic                    rst_i,
    input  logic                    job_valid_i,
    output logic                    job_ready_o,
    input  job_t                    job_i,
    input  logic [9:0]              image_width_i,
    input  logic [9:0]              image_height_i,
    input  logic [7:0]              slot_valid_i,
    output logic [7:0]              slot_busy_o,
    output logic                    rd_valid_o,
    output logic [AddrW-1:0]        rd_addr_o,
    input  logic [GroupBits-1:0]    rd_data_i,
    output logic                    surf_tvalid_o,
    input  logic                    surf_tready_i,
    output logic [15:0]             surf_tdata_o,
    output logic                    surf_tuser_o,
    output logic                    surf_tlast_o,
    output logic                    res_valid_o,
    input  logic                    res_ready_i,
    output result_t                 res_o,
    output logic [ResultLevelW-1:0] res_level_o,
    output logic                    busy_o,
    output logic                    score_o
);
  localparam int unsigned RowW       = $clog2(RingRows) + 1;
  localparam int unsigned SearchBits = GroupBits + Lanes - 1;
  localparam int unsigned LaneW      = $clog2(Lanes + 1);

  logic wr_valid, wr_tpl, wr_wide, wr_bank, fetch_busy, sequencer_busy;
  logic [7:0] wr_row;
  logic [3:0] wr_word;
  logic [GroupBits-1:0] wr_data;
  logic ticket_valid, ticket_ready, bank_free;
  ticket_t ticket;
  logic [1:0] tpl_done;
  logic [RowW-1:0] rows_written, rows_freed;
  logic ctx_valid, ctx_ready, row_valid, row_ready;
  context_t ctx;
  logic [9:0] row_offsets;
  step_t step;
  logic [2*GroupBits-1:0] mask;
  logic move, valid, first, last;
  logic [LaneW-1:0] lanes;
  logic [GroupBits-1:0] tpl_a, tpl_b;
  logic [SearchBits-1:0] search_a, search_b;
  logic mismatch_valid;
  logic [ScoreBits-1:0] mismatch;

  slog_fetch #(
      .Width(GroupBits),
      .MaxHeight(MaxHeight),
      .WordsPerRow(WordsPerRow),
      .Slots(Slots),
      .MinWindow(MinWindow),
      .MaxWindow(MaxWindow),
      .RingRows(RingRows)
  ) u_fetch (
      .clk_i,
      .rst_i,
      .job_valid_i,
      .job_ready_o,
      .job_i,
      .image_width_i,
      .image_height_i,
      .slot_valid_i,
      .slot_busy_o,
      .rd_valid_o,
      .rd_addr_o,
      .rd_data_i,
      .wr_valid_o    (wr_valid),
      .wr_tpl_o      (wr_tpl),
      .wr_wide_o     (wr_wide),
      .wr_bank_o     (wr_bank),
      .wr_row_o      (wr_row),
      .wr_word_o     (wr_word),
      .wr_data_o     (wr_data),
      .ticket_valid_o(ticket_valid),
      .ticket_ready_i(ticket_ready),
      .ticket_o      (ticket),
      .tpl_done_o    (tpl_done),
      .rows_written_o(rows_written),
      .rows_freed_i  (rows_freed),
      .bank_free_i   (bank_free),
      .busy_o        (fetch_busy)
  );

  slog_sequencer #(
      .GroupBits(GroupBits),
      .Pitch(Pitch),
      .RingRows(RingRows),
      .DrainClocks(slog_array_pkg::drain_clocks(GroupBits, Lanes))
  ) u_sequencer (
      .clk_i,
      .rst_i,
      .ticket_valid_i(ticket_valid),
      .ticket_ready_o(ticket_ready),
      .ticket_i      (ticket),
      .tpl_done_i    (tpl_done),
      .rows_written_i(rows_written),
      .rows_freed_o  (rows_freed),
      .bank_free_o   (bank_free),
      .ctx_valid_o   (ctx_valid),
      .ctx_ready_i   (ctx_ready),
      .ctx_o         (ctx),
      .row_valid_o   (row_valid),
      .row_ready_i   (row_ready),
      .row_offsets_o (row_offsets),
      .step_o        (step),
      .mask_o        (mask),
      .busy_o        (sequencer_busy)
  );

  // Holding the array while it is idle saves simulation time; in hardware it would cost a clock enable on every
  // register of the array.
`ifdef SLOG_CLOCK_GATE
  localparam bit HoldIdle = 1'b1;
`else
  localparam bit HoldIdle = 1'b0;
`endif
  slog_operands #(
      .GroupBits(GroupBits),
      .Lanes(Lanes),
      .RingRows(RingRows),
      .WordsPerRow(WordsPerRow),
      .HoldIdle(HoldIdle)
  ) u_operands (
      .clk_i,
      .rst_i,
      .wr_valid_i(wr_valid),
      .wr_tpl_i  (wr_tpl),
      .wr_wide_i (wr_wide),
      .wr_bank_i (wr_bank),
      .wr_row_i  (wr_row),
      .wr_word_i (wr_word),
      .wr_data_i (wr_data),
      .step_i    (step),
      .move_o    (move),
      .valid_o   (valid),
      .first_o   (first),
      .last_o    (last),
      .row_b_o   (),
      .lanes_o   (lanes),
      .tpl_a_o   (tpl_a),
      .tpl_b_o   (tpl_b),
      .search_a_o(search_a),
      .search_b_o(search_b)
  );

  slog_array #(
      .GroupBits(GroupBits),
      .Lanes(Lanes)
  ) u_array (
      .clk_i,
      .rst_i,
      .move_i          (move),
      .mask_i          (mask),
      .valid_i         (valid),
      .first_i         (first),
      .last_i          (last),
      .lanes_i         (lanes),
      .tpl_a_i         (tpl_a),
      .tpl_b_i         (tpl_b),
      .search_a_i      (search_a),
      .search_b_i      (search_b),
      .mismatch_valid_o(mismatch_valid),
      .mismatch_o      (mismatch)
  );

  slog_peak #(
      .MaxOffsets (MaxWidth),
      .ScoreBits  (ScoreBits),
      .ScoreDepth (SurfaceDepth),
      .ResultDepth(ResultDepth)
  ) u_peak (
      .clk_i,
      .rst_i,
      .ctx_valid_i     (ctx_valid),
      .ctx_ready_o     (ctx_ready),
      .ctx_i           (ctx),
      .row_valid_i     (row_valid),
      .row_ready_o     (row_ready),
      .row_offsets_i   (row_offsets),
      .mismatch_valid_i(mismatch_valid),
      .mismatch_i      (mismatch),
      .surf_tvalid_o,
      .surf_tready_i,
      .surf_tdata_o,
      .surf_tuser_o,
      .surf_tlast_o,
      .res_valid_o,
      .res_ready_i,
      .res_o,
      .res_level_o
  );

  logic [2:0] at_work_q;
  logic busy_q;
  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      at_work_q <= '0;
      busy_q    <= 1'b0;
    end else begin
      at_work_q <= {job_valid_i, fetch_busy, sequencer_busy};
      busy_q    <= at_work_q != '0;
    end
  end
  assign busy_o = busy_q;

  // Pipeline register: the counter is far from the peak unit.
  logic score_q;
  always_ff @(posedge clk_i) begin
    if (rst_i) score_q <= 1'b0;
    else score_q <= mismatch_valid;
  end
  assign score_o = score_q;

  `SLOG_ASSERT_INIT(SlogCorrelatorGroup, GroupBits == 2 * Pitch && Lanes == Pitch + 1
                                         && ScoreBits == slog_array_pkg::score_bits(GroupBits))
  `SLOG_ASSERT_INIT(SlogCorrelatorImage, WordsPerRow == (MaxWidth + GroupBits - 1) / GroupBits
                                         && MaxWindow <= 2 * GroupBits && SurfaceDepth >= MaxWidth)
endmodule : slog_correlator
