// SPDX-License-Identifier: Apache-2.0
// slog_operands feeding slog_array: the ports towards fetch and sequencer, the operands in between, and the scores.
module tb_operand_array #(
    parameter  int unsigned GroupBits   = 8,
    parameter  int unsigned RingRows    = 32,
    parameter  int unsigned WordsPerRow = 6,
    parameter  bit          HoldIdle    = 1'b1,
    localparam int unsigned Lanes       = GroupBits / 2 + 1,
    localparam int unsigned SearchBits  = GroupBits + Lanes - 1,
    localparam int unsigned LaneW       = $clog2(Lanes + 1),
    localparam int unsigned ScoreBits   = slog_array_pkg::score_bits(GroupBits)
) (
    input  logic                   clk_i,
    input  logic                   rst_i,
    input  logic                   wr_valid_i,
    input  logic                   wr_tpl_i,
    input  logic                   wr_wide_i,
    input  logic                   wr_bank_i,
    input  logic [7:0]             wr_row_i,
    input  logic [3:0]             wr_word_i,
    input  logic [GroupBits-1:0]   wr_data_i,
    input  slog_pkg::step_t        step_i,
    input  logic [2*GroupBits-1:0] mask_i,
    output logic                   move_o,
    output logic                   valid_o,
    output logic                   first_o,
    output logic                   last_o,
    output logic                   row_b_o,
    output logic [LaneW-1:0]       lanes_o,
    output logic [GroupBits-1:0]   tpl_a_o,
    output logic [GroupBits-1:0]   tpl_b_o,
    output logic [SearchBits-1:0]  search_a_o,
    output logic [SearchBits-1:0]  search_b_o,
    output logic                   mismatch_valid_o,
    output logic [ScoreBits-1:0]   mismatch_o
);
  slog_operands #(
      .GroupBits(GroupBits), .RingRows(RingRows), .WordsPerRow(WordsPerRow), .HoldIdle(HoldIdle)
  ) u_operands (.*);

  slog_array #(.GroupBits(GroupBits), .Lanes(Lanes)) u_array (
      .clk_i,
      .rst_i,
      .move_i    (move_o),
      .mask_i,
      .valid_i   (valid_o),
      .first_i   (first_o),
      .last_i    (last_o),
      .lanes_i   (lanes_o),
      .tpl_a_i   (tpl_a_o),
      .tpl_b_i   (tpl_b_o),
      .search_a_i(search_a_o),
      .search_b_i(search_b_o),
      .mismatch_valid_o,
      .mismatch_o
  );
endmodule : tb_operand_array
