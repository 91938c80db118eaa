// SPDX-License-Identifier: Apache-2.0
// Peak unit: finds each job's best score, its neighbours and the runner-up from the array's mismatch counts.
//
// score = area - mismatch, in raster order over the offsets of a job.
//
// Handshake  : the array cannot be stopped within a row of offsets, so room for a whole row is reserved before it
//              starts: a row is granted in a clock with row_valid_i and row_ready_o, in which row_offsets_i is the
//              job's offsets_x. row_ready_o does not depend on row_valid_i and is low for one clock after each grant;
//              ctx_ready_o does not depend on ctx_valid_i: a context is taken in every other clock at most.
//              A job's context must be taken (ctx_valid_i, ctx_ready_o) no later than in the clock of its first grant.
//              Scores of granted rows arrive in grant order, gaps allowed; they are always accepted.
// Results    : one in two clocks at most. Results and surface scores stay offered, unchanged, until they are taken.
// Formats    : mismatch_i unsigned; scores ScoreW bits; absent scores in res_o are NoScore.
// Ties       : the first in raster order is the best.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_peak
  import slog_pkg::*;
  import slog_peak_pkg::*;
#(
    parameter  int unsigned MaxOffsets  = 640,          // maximum of offsets_x
    parameter  int unsigned ScoreBits   = 15,           // bits of mismatch_i
    parameter  int unsigned ScoreDepth  = 1024,         // scores held between array and peak search, >= MaxOffsets
    parameter  int unsigned ResultDepth = 64,           // results held for the host
    localparam int unsigned ResultLevelW = $clog2(ResultDepth + 1)
) (
    input  logic                    clk_i,
    input  logic                    rst_i,
    // Contexts in job order, refused jobs too.
    input  logic                    ctx_valid_i,
    output logic                    ctx_ready_o,
    input  context_t                ctx_i,
    // Row grants.
    input  logic                    row_valid_i,
    output logic                    row_ready_o,
    input  logic [9:0]              row_offsets_i,
    // Array.
    input  logic                    mismatch_valid_i,
    input  logic [ScoreBits-1:0]    mismatch_i,
    // Scores of jobs that asked for their surface: raster order, tuser = first of the job, tlast = last of the job.
    output logic                    surf_tvalid_o,
    input  logic                    surf_tready_i,
    output logic [15:0]             surf_tdata_o,
    output logic                    surf_tuser_o,
    output logic                    surf_tlast_o,
    // Results in job order.
    output logic                    res_valid_o,
    input  logic                    res_ready_i,
    output result_t                 res_o,
    output logic [ResultLevelW-1:0] res_level_o
);
  localparam int unsigned Banks = 4;
  localparam int unsigned RowDepth = 4;    // rows begun and not yet decided: each occupies a bank
  localparam int unsigned RowLevelW = $clog2(RowDepth + 1);
  localparam int unsigned ContextDepth = 8;
  localparam int unsigned OutcomeDepth = 8;  // rows in the scan's pipeline: one in two clocks
  localparam int unsigned SurfaceDepth = 16;
  localparam int unsigned SurfaceRoom = 6;   // scores that may still arrive after surf_ok_q falls

  // Pipeline registers: the array is far.
  logic arrived_q;
  logic [ScoreBits-1:0] mismatch_q;
  always_ff @(posedge clk_i) begin
    if (rst_i) arrived_q <= 1'b0;
    else arrived_q <= mismatch_valid_i;
  end
  always_ff @(posedge clk_i) mismatch_q <= mismatch_i;

  // Queue of scores: accepts whole rows even while the search is stalled.
  logic queue_valid, queue_ready, queue_room;
  logic [ScoreBits-1:0] queue_mismatch;
  logic [$clog2(ScoreDepth+1)-1:0] unused_queue_level;
  slog_ram_fifo #(.Width(ScoreBits), .Depth(ScoreDepth), .Kept(1'b1)) u_queue (
      .clk_i, .rst_i, .in_valid_i(arrived_q), .in_ready_o(queue_room), .in_data_i(mismatch_q),
      .out_valid_o(queue_valid), .out_ready_i(queue_valid && queue_ready), .out_data_o(queue_mismatch),
      .level_o(unused_queue_level));

  // Grants are made near the sequencer, so the freed places reach u_room through a register.
  logic taken_q;
  always_ff @(posedge clk_i) begin
    if (rst_i) taken_q <= 1'b0;
    else taken_q <= queue_valid && queue_ready;
  end
  slog_peak_room #(.Depth(ScoreDepth), .MaxOffsets(MaxOffsets)) u_room (
      .clk_i, .rst_i, .row_valid_i, .row_ready_o, .row_offsets_i, .taken_i(taken_q));

  // Contexts, unrolled into rows. The first stage covers the distance from the sequencer.
  logic ctx_valid, ctx_ready, near_ctx_valid, near_ctx_ready, queued_ctx_valid, queued_ctx_ready;
  context_t ctx, near_ctx, queued_ctx;
  logic [$clog2(ContextDepth+1)-1:0] unused_ctx_level;
  slog_stage #(.Width($bits(context_t)), .Half(1'b1)) u_near_context (
      .clk_i, .rst_i, .in_valid_i(ctx_valid_i), .in_ready_o(ctx_ready_o), .in_data_i(ctx_i),
      .out_valid_o(near_ctx_valid), .out_ready_i(near_ctx_ready), .out_data_o(near_ctx));
  slog_fifo #(.Width($bits(context_t)), .Depth(ContextDepth)) u_contexts (
      .clk_i, .rst_i, .in_valid_i(near_ctx_valid), .in_ready_o(near_ctx_ready), .in_data_i(near_ctx),
      .out_valid_o(queued_ctx_valid), .out_ready_i(queued_ctx_ready), .out_data_o(queued_ctx),
      .level_o(unused_ctx_level));
  slog_stage #(.Width($bits(context_t)), .Half(1'b1)) u_context (
      .clk_i, .rst_i, .in_valid_i(queued_ctx_valid), .in_ready_o(queued_ctx_ready), .in_data_i(queued_ctx),
      .out_valid_o(ctx_valid), .out_ready_i(ctx_ready), .out_data_o(ctx));

  logic row_coming, row_taken, row_refused, no_row_q;  // no_row_q: no row was taken in the clock before
  row_t row;
  scoring_t scoring;
  slog_peak_rows u_rows (
      .clk_i, .rst_i, .ctx_valid_i(ctx_valid), .ctx_ready_o(ctx_ready), .ctx_i(ctx),
      .row_coming_o(row_coming), .row_taken_i(row_taken), .row_o(row), .refused_o(row_refused),
      .scoring_o(scoring));
  always_ff @(posedge clk_i) begin
    if (rst_i) no_row_q <= 1'b1;
    else no_row_q <= !row_taken;
  end

  // Scores with their columns and banks.
  logic score_valid, score_first, score_last, surf_valid, surf_first, surf_last, surf_ok_q, surf_ok_q2;
  logic [9:0] score_x;
  logic [ScoreW-1:0] score;
  logic [Banks-1:0] write_bank;
  logic [1:0] released;
  slog_peak_intake #(.ScoreBits(ScoreBits), .Banks(Banks)) u_intake (
      .clk_i, .rst_i, .row_coming_i(row_coming), .row_taken_o(row_taken), .row_refused_i(row_refused),
      .row_last_x_i(row.last_x), .row_first_i(row.first), .row_last_i(row.last), .scoring_i(scoring),
      .released_i(released),
      .mismatch_valid_i(queue_valid), .mismatch_ready_o(queue_ready), .mismatch_i(queue_mismatch),
      .score_valid_o(score_valid), .score_first_o(score_first), .score_last_o(score_last), .score_x_o(score_x),
      .score_o(score), .bank_o(write_bank),
      .surf_valid_o(surf_valid), .surf_first_o(surf_first), .surf_last_o(surf_last), .surf_ok_i(surf_ok_q2));

  // Surface stream.
  logic surf_room;
  logic [$clog2(SurfaceDepth+1)-1:0] surf_level;
  assign surf_tdata_o[15:ScoreW] = '0;
  slog_fifo #(.Width(ScoreW + 2), .Depth(SurfaceDepth), .Kept(1'b1)) u_surface (
      .clk_i, .rst_i, .in_valid_i(surf_valid), .in_ready_o(surf_room), .in_data_i({surf_last, surf_first, score}),
      .out_valid_o(surf_tvalid_o), .out_ready_i(surf_tvalid_o && surf_tready_i),
      .out_data_o({surf_tlast_o, surf_tuser_o, surf_tdata_o[ScoreW-1:0]}), .level_o(surf_level));
  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      surf_ok_q  <= 1'b0;
      surf_ok_q2 <= 1'b0;
    end else begin
      surf_ok_q  <= 32'(surf_level) <= SurfaceDepth - SurfaceRoom;
      surf_ok_q2 <= surf_ok_q;
    end
  end

  // Row banks: row r of offsets, counted over all jobs, is in bank r mod Banks. A new row never overtakes a scan that
  // still reads the bank.
  logic [Banks-1:0] read;
  logic [9:0] read_x;
  logic [Banks-1:0][ScoreW-1:0] bank_data;
  localparam int unsigned AddrW = $clog2(MaxOffsets);
  for (genvar b = 0; b < Banks; b++) begin : g_bank
    slog_ram #(.Width(ScoreW), .Depth(MaxOffsets)) u_ram (
        .clk_i, .wr_en_i(write_bank[b]), .wr_addr_i(score_x[AddrW-1:0]), .wr_data_i(score),
        .rd_en_i(read[b]), .rd_addr_i(read_x[AddrW-1:0]), .rd_data_o(bank_data[b]));
  end

  // Each row's maximum, in a queue parallel to that of the rows.
  logic max_valid;
  logic [ScoreW-1:0] max_score;
  logic [9:0] max_x;
  slog_running_max #(.ValueW(ScoreW), .IndexW(10)) u_max (
      .clk_i, .rst_i, .in_valid_i(score_valid), .in_first_i(score_first), .in_last_i(score_last),
      .in_value_i(score), .in_index_i(score_x),
      .out_valid_o(max_valid), .out_value_o(max_score), .out_index_o(max_x));

  logic begun_valid, begun_ready, begun_room, queued_begun_valid, queued_begun_ready, top_valid, top_ready, top_room;
  row_t begun, queued_begun;
  logic [ScoreW-1:0] top_score;
  logic [9:0] top_x;
  logic [RowLevelW-1:0] top_level, unused_begun_level;
  slog_fifo #(.Width($bits(row_t)), .Depth(RowDepth), .Kept(1'b1)) u_begun (
      .clk_i, .rst_i, .in_valid_i(!no_row_q), .in_ready_o(begun_room), .in_data_i(row),
      .out_valid_o(queued_begun_valid), .out_ready_i(queued_begun_valid && queued_begun_ready),
      .out_data_o(queued_begun), .level_o(unused_begun_level));
  slog_stage #(.Width($bits(row_t)), .Half(1'b1)) u_begun_stage (
      .clk_i, .rst_i, .in_valid_i(queued_begun_valid), .in_ready_o(queued_begun_ready), .in_data_i(queued_begun),
      .out_valid_o(begun_valid), .out_ready_i(begun_ready), .out_data_o(begun));
  slog_fifo #(.Width(ScoreW + 10), .Depth(RowDepth), .Kept(1'b1)) u_tops (
      .clk_i, .rst_i, .in_valid_i(max_valid), .in_ready_o(top_room), .in_data_i({max_score, max_x}),
      .out_valid_o(top_valid), .out_ready_i(top_ready), .out_data_o({top_score, top_x}), .level_o(top_level));

  // Search.
  logic order_valid, order_room, decided_valid, room;
  scan_t order;
  outcome_t decided;
  slog_peak_best #(.RowDepth(RowDepth)) u_best (
      .clk_i, .rst_i, .row_valid_i(begun_valid), .row_ready_o(begun_ready), .row_i(begun),
      .top_level_i(top_level), .top_coming_i(max_valid), .top_ready_o(top_ready), .top_score_i(top_score),
      .top_x_i(top_x), .room_i(room), .order_room_i(order_room), .order_valid_o(order_valid), .order_o(order),
      .outcome_valid_o(decided_valid), .outcome_o(decided), .released_o(released));

  logic near_first, near_end, near_west, near_centre, near_east, far_valid;
  maybe_t near_above, near_middle, near_below, far;
  slog_peak_scan #(.Banks(Banks)) u_scan (
      .clk_i, .rst_i, .order_valid_i(order_valid), .order_room_o(order_room), .order_i(order),
      .read_o(read), .read_x_o(read_x), .data_i(bank_data),
      .near_first_o(near_first), .near_end_o(near_end), .near_west_o(near_west),
      .near_centre_o(near_centre), .near_east_o(near_east), .near_above_o(near_above),
      .near_middle_o(near_middle), .near_below_o(near_below), .far_valid_o(far_valid), .far_o(far));

  logic outcome_valid, outcome_room;
  outcome_t outcome;
  logic [$clog2(OutcomeDepth+1)-1:0] unused_outcome_level;
  slog_fifo #(.Width($bits(outcome_t)), .Depth(OutcomeDepth), .Kept(1'b1)) u_outcomes (
      .clk_i, .rst_i, .in_valid_i(decided_valid), .in_ready_o(outcome_room), .in_data_i(decided),
      .out_valid_o(outcome_valid), .out_ready_i(far_valid), .out_data_o(outcome), .level_o(unused_outcome_level));

  logic around_valid, verdict_valid;
  logic [7:0][ScoreW-1:0] around;
  verdict_t verdict;
  slog_peak_collect u_collect (
      .clk_i, .rst_i, .near_first_i(near_first), .near_end_i(near_end),
      .near_west_i(near_west), .near_centre_i(near_centre), .near_east_i(near_east), .near_above_i(near_above),
      .near_middle_i(near_middle), .near_below_i(near_below), .far_valid_i(far_valid), .far_i(far),
      .outcome_i(outcome), .around_valid_o(around_valid), .around_o(around),
      .verdict_valid_o(verdict_valid), .verdict_o(verdict));

  // Results: the neighbours are complete before the rest, so each part has a queue; both leave together to a register.
  // A job's last row is scanned only when a place is reserved for its result, so neither queue overflows.
  logic around_room, around_out_valid, verdict_room, verdict_out_valid, result_room, result_pop;
  verdict_t verdict_out;
  logic [7:0][ScoreW-1:0] around_out;
  logic [ResultLevelW-1:0] unused_around_level, unused_verdict_level, kept_q, level_q;
  logic keep, popped;            // a place is reserved; a result leaves
  logic keep_q, popped_q;        // one clock late
  logic kept_all_q, kept_one_q;  // no free place is left; one is left
  logic room_q;
  slog_ram_fifo #(.Width(8 * ScoreW), .Depth(ResultDepth), .Kept(1'b1)) u_around (
      .clk_i, .rst_i, .in_valid_i(around_valid), .in_ready_o(around_room), .in_data_i(around),
      .out_valid_o(around_out_valid), .out_ready_i(result_pop), .out_data_o(around_out),
      .level_o(unused_around_level));
  slog_ram_fifo #(.Width($bits(verdict_t)), .Depth(ResultDepth), .Kept(1'b1)) u_verdict (
      .clk_i, .rst_i, .in_valid_i(verdict_valid), .in_ready_o(verdict_room), .in_data_i(verdict),
      .out_valid_o(verdict_out_valid), .out_ready_i(result_pop), .out_data_o(verdict_out),
      .level_o(unused_verdict_level));

  result_t whole;
  assign result_pop = verdict_out_valid && result_room;  // the neighbours are queued earlier
  assign whole = '{tag: verdict_out.tag, status: verdict_out.status, best_x: verdict_out.best_x,
                   best_y: verdict_out.best_y, score: verdict_out.score, neighbour: around_out,
                   runner_up: verdict_out.runner_up};
  slog_stage #(.Width($bits(result_t)), .Half(1'b1)) u_result (
      .clk_i, .rst_i, .in_valid_i(verdict_out_valid), .in_ready_o(result_room), .in_data_i(whole),
      .out_valid_o(res_valid_o), .out_ready_i(res_ready_i), .out_data_o(res_o));
  assign res_level_o = level_q;

  assign keep   = decided_valid && decided.last;
  assign popped = res_valid_o && res_ready_i;
  assign room   = room_q;
  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      kept_q     <= '0;
      kept_all_q <= 1'b0;
      kept_one_q <= 1'b0;
      room_q     <= 1'b1;
      keep_q     <= 1'b0;
      popped_q   <= 1'b0;
      level_q    <= '0;
    end else begin
      // Orders are at least two clocks apart, so keep_q and keep cover every order not counted yet.
      room_q   <= popped_q || !(kept_all_q || (kept_one_q && (keep_q || keep)));
      keep_q   <= keep;
      popped_q <= popped;
      if (verdict_valid != popped) level_q <= level_q + ResultLevelW'({ResultLevelW{popped}} | 1'b1);
      if (keep_q != popped_q) begin
        kept_q     <= kept_q + ResultLevelW'({ResultLevelW{popped_q}} | 1'b1);
        kept_all_q <= !popped_q && kept_one_q;
        kept_one_q <= popped_q ? kept_all_q : kept_q == ResultLevelW'(ResultDepth - 2);
      end
    end
  end

  `SLOG_ASSERT(SlogPeakScoreGranted, !arrived_q || queue_room)
  `SLOG_ASSERT(SlogPeakColumns, (read == '0 || 32'(read_x) < MaxOffsets) && (!score_valid || 32'(score_x) < MaxOffsets))
  `SLOG_ASSERT(SlogPeakSurfaceRoom, !surf_valid || surf_room)
  `SLOG_ASSERT(SlogPeakRowRoom, (no_row_q || begun_room) && (!max_valid || top_room))
  `SLOG_ASSERT(SlogPeakTopThere, !top_ready || top_valid)
  `SLOG_ASSERT(SlogPeakOutcomeRoom, !decided_valid || outcome_room)
  `SLOG_ASSERT(SlogPeakOutcomeThere, !far_valid || outcome_valid)
  `SLOG_ASSERT(SlogPeakResultRoom, (!around_valid || around_room) && (!verdict_valid || verdict_room))
  `SLOG_ASSERT(SlogPeakResultWhole, !verdict_out_valid || around_out_valid)
  `SLOG_ASSERT(SlogPeakLevel, level_q <= kept_q + ResultLevelW'(keep_q))
  `SLOG_ASSERT(SlogPeakRoom, room_q == (!kept_all_q && !(kept_one_q && keep_q)))
  `SLOG_ASSERT(SlogPeakKept, kept_all_q == (kept_q == ResultLevelW'(ResultDepth))
                             && kept_one_q == (kept_q == ResultLevelW'(ResultDepth - 1)))
  `SLOG_ASSERT_INIT(SlogPeakSizes, ScoreDepth >= MaxOffsets && MaxOffsets <= 1023 && ScoreBits <= ScoreW
                                   && ResultDepth >= 2)
  `SLOG_ASSERT_STABLE(SlogPeakSurfaceStable, surf_tvalid_o, surf_tready_i, {surf_tdata_o, surf_tuser_o, surf_tlast_o})
  `SLOG_ASSERT_STABLE(SlogPeakResultStable, res_valid_o, res_ready_i, res_o)
  `SLOG_ASSERT_NEXT(SlogPeakResultsApart, res_valid_o && res_ready_i, !res_valid_o)
  `SLOG_ASSERT_NEXT(SlogPeakContextsApart, ctx_valid_i && ctx_ready_o, !ctx_ready_o)
  `SLOG_ASSERT(SlogPeakNotOvertaken, (write_bank & read) == '0 || score_x < read_x)
`ifndef SYNTHESIS
  // Rows of the contexts taken, less the rows granted.
  int unsigned rows_owed;
  logic ctx_scored;
  assign ctx_scored = ctx_valid_i && ctx_ready_o && ctx_i.status == StatusOk;
  always_ff @(posedge clk_i) begin
    if (rst_i) rows_owed <= 0;
    else rows_owed <= rows_owed + (ctx_scored ? 32'(ctx_i.offsets_y) : 0) - 32'(row_valid_i && row_ready_o);
  end
`endif
  `SLOG_ASSERT(SlogPeakContextFirst, !(row_valid_i && row_ready_o) || rows_owed != 0 || ctx_scored)
endmodule : slog_peak
