// SPDX-License-Identifier: Apache-2.0
// The parts of slog_peak side by side, each with its own ports, so that one build tests them all.
module tb_peak_parts
  import slog_pkg::*;
  import slog_peak_pkg::*;
#(
    parameter int unsigned MaxOffsets = 48,
    parameter int unsigned ScoreBits  = 9,
    parameter int unsigned ScoreDepth = 128,
    parameter int unsigned Banks      = 4
) (
    input  logic clk_i,
    input  logic rst_i,
    input  logic stage_in_valid_i,
    output logic stage_in_ready_o,
    input  logic [11:0] stage_in_data_i,
    output logic stage_out_valid_o,
    input  logic stage_out_ready_i,
    output logic [11:0] stage_out_data_o,
    input  logic half_in_valid_i,
    output logic half_in_ready_o,
    input  logic [11:0] half_in_data_i,
    output logic half_out_valid_o,
    input  logic half_out_ready_i,
    output logic [11:0] half_out_data_o,
    input  logic room_row_valid_i,
    output logic room_row_ready_o,
    input  logic [9:0] room_row_offsets_i,
    input  logic room_taken_i,
    input  logic rows_ctx_valid_i,
    output logic rows_ctx_ready_o,
    input  context_t rows_ctx_i,
    output logic rows_row_coming_o,
    input  logic rows_row_taken_i,
    output row_t rows_row_o,
    output scoring_t rows_scoring_o,
    input  logic intake_row_coming_i,
    output logic intake_row_taken_o,
    input  logic intake_row_refused_i,
    input  logic [9:0] intake_row_last_x_i,
    input  logic intake_row_first_i,
    input  logic intake_row_last_i,
    input  scoring_t intake_scoring_i,
    input  logic [1:0] intake_released_i,
    input  logic intake_mismatch_valid_i,
    output logic intake_mismatch_ready_o,
    input  logic [ScoreBits-1:0] intake_mismatch_i,
    output logic intake_score_valid_o,
    output logic intake_score_first_o,
    output logic intake_score_last_o,
    output logic [9:0] intake_score_x_o,
    output logic [ScoreW-1:0] intake_score_o,
    output logic [Banks-1:0] intake_bank_o,
    output logic intake_surf_valid_o,
    output logic intake_surf_first_o,
    output logic intake_surf_last_o,
    input  logic intake_surf_ok_i,
    input  logic max_in_valid_i,
    input  logic max_in_first_i,
    input  logic max_in_last_i,
    input  logic [ScoreW-1:0] max_in_value_i,
    input  logic [9:0] max_in_index_i,
    output logic max_out_valid_o,
    output logic [ScoreW-1:0] max_out_value_o,
    output logic [9:0] max_out_index_o,
    input  logic best_row_valid_i,
    output logic best_row_ready_o,
    input  row_t best_row_i,
    input  logic [$clog2(Banks+1)-1:0] best_top_level_i,
    input  logic best_top_coming_i,
    output logic best_top_ready_o,
    input  logic [ScoreW-1:0] best_top_score_i,
    input  logic [9:0] best_top_x_i,
    input  logic best_room_i,
    output logic best_order_valid_o,
    output logic best_outcome_valid_o,
    input  logic best_order_room_i,
    output scan_t best_order_o,
    output outcome_t best_outcome_o,
    output logic [1:0] best_released_o,
    input  logic scan_order_valid_i,
    output logic scan_order_room_o,
    input  scan_t scan_order_i,
    output logic [Banks-1:0] scan_read_o,
    output logic [9:0] scan_read_x_o,
    input  logic [Banks-1:0][ScoreW-1:0] scan_data_i,
    output logic scan_near_first_o,
    output logic scan_near_end_o,
    output logic scan_near_west_o,
    output logic scan_near_centre_o,
    output logic scan_near_east_o,
    output maybe_t scan_near_above_o,
    output maybe_t scan_near_middle_o,
    output maybe_t scan_near_below_o,
    output logic scan_far_valid_o,
    output maybe_t scan_far_o,
    input  logic collect_near_first_i,
    input  logic collect_near_end_i,
    input  logic collect_near_west_i,
    input  logic collect_near_centre_i,
    input  logic collect_near_east_i,
    input  maybe_t collect_near_above_i,
    input  maybe_t collect_near_middle_i,
    input  maybe_t collect_near_below_i,
    input  logic collect_far_valid_i,
    input  maybe_t collect_far_i,
    input  outcome_t collect_outcome_i,
    output logic collect_around_valid_o,
    output logic [7:0][ScoreW-1:0] collect_around_o,
    output logic collect_verdict_valid_o,
    output verdict_t collect_verdict_o
);
  slog_stage #(.Width(12)) u_stage (
      .clk_i, .rst_i, .in_valid_i(stage_in_valid_i), .in_ready_o(stage_in_ready_o), .in_data_i(stage_in_data_i),
      .out_valid_o(stage_out_valid_o), .out_ready_i(stage_out_ready_i), .out_data_o(stage_out_data_o));

  slog_stage #(.Width(12), .Half(1'b1)) u_half (
      .clk_i, .rst_i, .in_valid_i(half_in_valid_i), .in_ready_o(half_in_ready_o), .in_data_i(half_in_data_i),
      .out_valid_o(half_out_valid_o), .out_ready_i(half_out_ready_i), .out_data_o(half_out_data_o));

  slog_peak_room #(.Depth(ScoreDepth), .MaxOffsets(MaxOffsets)) u_room (
      .clk_i, .rst_i, .row_valid_i(room_row_valid_i), .row_ready_o(room_row_ready_o),
      .row_offsets_i(room_row_offsets_i), .taken_i(room_taken_i));

  logic unused_rows_refused;
  slog_peak_rows u_rows (
      .clk_i, .rst_i, .ctx_valid_i(rows_ctx_valid_i), .ctx_ready_o(rows_ctx_ready_o), .ctx_i(rows_ctx_i),
      .row_coming_o(rows_row_coming_o), .row_taken_i(rows_row_taken_i), .row_o(rows_row_o),
      .refused_o(unused_rows_refused), .scoring_o(rows_scoring_o));

  slog_peak_intake #(.ScoreBits(ScoreBits), .Banks(Banks)) u_intake (
      .clk_i, .rst_i, .row_coming_i(intake_row_coming_i), .row_taken_o(intake_row_taken_o),
      .row_refused_i(intake_row_refused_i), .row_last_x_i(intake_row_last_x_i), .row_first_i(intake_row_first_i),
      .row_last_i(intake_row_last_i), .scoring_i(intake_scoring_i), .released_i(intake_released_i),
      .mismatch_valid_i(intake_mismatch_valid_i), .mismatch_ready_o(intake_mismatch_ready_o),
      .mismatch_i(intake_mismatch_i), .score_valid_o(intake_score_valid_o), .score_first_o(intake_score_first_o),
      .score_last_o(intake_score_last_o), .score_x_o(intake_score_x_o), .score_o(intake_score_o),
      .bank_o(intake_bank_o), .surf_valid_o(intake_surf_valid_o), .surf_first_o(intake_surf_first_o),
      .surf_last_o(intake_surf_last_o), .surf_ok_i(intake_surf_ok_i));

  slog_running_max #(.ValueW(ScoreW), .IndexW(10)) u_max (
      .clk_i, .rst_i, .in_valid_i(max_in_valid_i), .in_first_i(max_in_first_i), .in_last_i(max_in_last_i),
      .in_value_i(max_in_value_i), .in_index_i(max_in_index_i), .out_valid_o(max_out_valid_o),
      .out_value_o(max_out_value_o), .out_index_o(max_out_index_o));

  slog_peak_best #(.RowDepth(Banks)) u_best (
      .clk_i, .rst_i, .row_valid_i(best_row_valid_i), .row_ready_o(best_row_ready_o), .row_i(best_row_i),
      .top_level_i(best_top_level_i), .top_coming_i(best_top_coming_i),
      .top_ready_o(best_top_ready_o), .top_score_i(best_top_score_i),
      .top_x_i(best_top_x_i), .room_i(best_room_i), .order_valid_o(best_order_valid_o),
      .outcome_valid_o(best_outcome_valid_o),
      .order_room_i(best_order_room_i), .order_o(best_order_o), .outcome_o(best_outcome_o),
      .released_o(best_released_o));

  slog_peak_scan #(.Banks(Banks)) u_scan (
      .clk_i, .rst_i, .order_valid_i(scan_order_valid_i), .order_room_o(scan_order_room_o), .order_i(scan_order_i),
      .read_o(scan_read_o), .read_x_o(scan_read_x_o), .data_i(scan_data_i),
      .near_first_o(scan_near_first_o), .near_end_o(scan_near_end_o), .near_west_o(scan_near_west_o),
      .near_centre_o(scan_near_centre_o), .near_east_o(scan_near_east_o), .near_above_o(scan_near_above_o),
      .near_middle_o(scan_near_middle_o), .near_below_o(scan_near_below_o), .far_valid_o(scan_far_valid_o),
      .far_o(scan_far_o));

  slog_peak_collect u_collect (
      .clk_i, .rst_i, .near_first_i(collect_near_first_i),
      .near_end_i(collect_near_end_i), .near_west_i(collect_near_west_i), .near_centre_i(collect_near_centre_i),
      .near_east_i(collect_near_east_i), .near_above_i(collect_near_above_i), .near_middle_i(collect_near_middle_i),
      .near_below_i(collect_near_below_i), .far_valid_i(collect_far_valid_i), .far_i(collect_far_i),
      .outcome_i(collect_outcome_i), .around_valid_o(collect_around_valid_o), .around_o(collect_around_o),
      .verdict_valid_o(collect_verdict_valid_o), .verdict_o(collect_verdict_o));
endmodule : tb_peak_parts
