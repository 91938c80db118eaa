// SPDX-License-Identifier: Apache-2.0
// slog_peak_intake against a plain count: each row taken gets its scores, area less mismatch, in columns 0 .. last_x, in
// the next bank; rows are taken only while a bank is free.
//
// For the induction the counts are compared with the module's own: its row data and its bank follow a row by one clock,
// its column follows a score by one.
module slog_rules_peak_intake
  import slog_pkg::*, slog_peak_pkg::*;
#(
    parameter int unsigned ScoreBits = 15,
    parameter int unsigned Banks     = 4
) (
    input logic                 clk_i,
    input logic                 rst_i,
    input logic                 row_coming_i,
    input logic                 row_taken_o,
    input logic                 row_refused_i,
    input logic [9:0]           row_last_x_i,
    input logic                 row_first_i,
    input logic                 row_last_i,
    input scoring_t             scoring_i,
    input logic [1:0]           released_i,
    input logic                 mismatch_valid_i,
    input logic                 mismatch_ready_o,
    input logic [ScoreBits-1:0] mismatch_i,
    input logic                 score_valid_o,
    input logic                 score_first_o,
    input logic                 score_last_o,
    input logic [9:0]           score_x_o,
    input logic [ScoreW-1:0]    score_o,
    input logic [Banks-1:0]     bank_o,
    input logic                 surf_valid_o,
    input logic                 surf_first_o,
    input logic                 surf_last_o,
    input logic                 surf_ok_i,
    input logic                 run_q,
    input logic                 go_q,
    input logic                 open_q,
    input logic                 surface_q,
    input logic                 take_q,
    input logic                 s1_valid_q,
    input logic                 s1_last_q,
    input logic [ScoreBits-1:0] s1_mismatch_q,
    input logic                 begin_q,
    input logic                 first_row_q,
    input logic                 last_row_q,
    input logic                 surface_row_q,
    input logic [ScoreW-1:0]    area_q,
    input logic [$bits(scoring_t)+1:0] past_row,
    // The module's own counts.
    input logic [9:0]           own_left,
    input logic [9:0]           own_x,
    input logic [Banks-1:0]     own_bank,
    input logic [$clog2(Banks+1)-1:0] own_used
);
  typedef struct packed {
    logic                     valid;
    logic                     surface;
    logic                     first;
    logic                     last;
    logic                     surf_first;
    logic                     surf_last;
    logic [9:0]               x;
    logic [ScoreW-1:0]        score;
    logic [$clog2(Banks)-1:0] bank;
  } wanted_t;
  typedef struct packed {
    logic       refused;
    logic [9:0] last_x;
    logic       first;
    logic       last;
    scoring_t   scoring;
  } inputs_t;
  inputs_t row, row_q, next_q;       // row_q: the row in work; next_q: the inputs in the clock before
  logic there_q, taken_q, ok_q;      // a row can be taken; one was in the clock before; surf_ok_i then
  logic [10:0] left_q;               // scores to come of the row in work
  logic [9:0] x_q;
  logic [2:0] used_q;
  logic [$clog2(Banks)-1:0] bank_q;
  wanted_t [1:0] wanted_q;
  logic waited_q;                    // a row could be taken in the clock before, and was not
  logic pop;
  assign row = '{refused: row_refused_i, last_x: row_last_x_i, first: row_first_i, last: row_last_i, scoring: scoring_i};
  assign pop = mismatch_valid_i && mismatch_ready_o;
  always_ff @(posedge clk_i) begin
    next_q <= row;
    ok_q   <= surf_ok_i;
    waited_q <= !rst_i && there_q && !row_taken_o;
    if (rst_i) begin
      there_q  <= 1'b0;
      taken_q  <= 1'b0;
      left_q   <= '0;
      used_q   <= '0;
      bank_q   <= '1;
      wanted_q <= '0;
    end else begin
      there_q  <= row_coming_i && !row_taken_o;
      taken_q  <= row_taken_o;
      used_q   <= used_q + 3'(row_taken_o) - 3'(released_i);
      wanted_q <= {wanted_q[0], wanted_t'{valid: pop, surface: row_q.scoring.surface, first: x_q == '0,
                   last: left_q == 11'd1, surf_first: x_q == '0 && row_q.first, surf_last: left_q == 11'd1 && row_q.last,
                   x: x_q, score: row_q.scoring.area - ScoreW'(mismatch_i), bank: bank_q}};
      if (row_taken_o) begin
        row_q  <= row;
        left_q <= row_refused_i ? '0 : 11'(row_last_x_i) + 11'd1;
        x_q    <= '0;
        bank_q <= bank_q + 1'b1;
      end else if (pop) begin
        left_q <= left_q - 1'b1;
        x_q    <= x_q + 1'b1;
      end
    end
    if (!rst_i) begin
      AssumeShort : assume (scoring_i.one == (row_last_x_i == '0) && scoring_i.two == (row_last_x_i == 10'd1));
      AssumeRowWaits : assume (!there_q || row_taken_o || row_coming_i);
      AssumeRowStays : assume (!there_q || !waited_q || row == next_q);
      AssumeReleased : assume (3'(released_i) <= used_q);
      RulesPeakIntakeTaken : assert (!row_taken_o || (there_q && 32'(used_q) < Banks && (left_q == '0 || (pop && left_q == 11'd1))));
      RulesPeakIntakePop : assert (!pop || left_q != '0);
      RulesPeakIntakeSurface : assert (!pop || !row_q.scoring.surface || ok_q);
      RulesPeakIntakeValid : assert (score_valid_o == wanted_q[1].valid && surf_valid_o == (wanted_q[1].valid && wanted_q[1].surface));
      RulesPeakIntakeScore : assert (!score_valid_o || ({score_first_o, score_last_o, score_x_o, score_o}
          == {wanted_q[1].first, wanted_q[1].last, wanted_q[1].x, wanted_q[1].score} && bank_o == Banks'(1) << wanted_q[1].bank));
      RulesPeakIntakeMarks : assert (!surf_valid_o || {surf_first_o, surf_last_o} == {wanted_q[1].surf_first, wanted_q[1].surf_last});
      RulesPeakIntakeOpen : assert (!open_q || (there_q && 32'(used_q) < Banks));
      RulesPeakIntakeUsed : assert (taken_q == take_q && used_q == 3'(own_used) + 3'(take_q));
      RulesPeakIntakeRun : assert (run_q == (left_q != '0) && (!run_q || left_q == 11'(own_left) + 11'd1));
      RulesPeakIntakeGo : assert (!go_q || (run_q && (!surface_q || ok_q)));
      RulesPeakIntakeOfRow : assert (!run_q || (surface_q == row_q.scoring.surface
                                                && 11'(x_q) + left_q == 11'(row_q.last_x) + 11'd1));
      RulesPeakIntakeEnter : assert (!take_q || (x_q == '0 && past_row == {row_q.first, row_q.last, row_q.scoring}));
      RulesPeakIntakeBanks : assert (own_bank == Banks'(1) << (bank_q - $clog2(Banks)'(take_q)));
      RulesPeakIntakeRow : assert (take_q || !run_q || (x_q == own_x + 10'(s1_valid_q) && {first_row_q, last_row_q,
          surface_row_q, area_q} == {row_q.first, row_q.last, row_q.scoring.surface, row_q.scoring.area}));
      RulesPeakIntakeFirst : assert (!(s1_valid_q || (run_q && !take_q)) || begin_q == (own_x == '0));
      RulesPeakIntakeStage : assert (s1_valid_q == wanted_q[0].valid && (!s1_valid_q || wanted_q[0] == wanted_t'{valid: 1'b1,
          surface: surface_row_q, first: begin_q, last: s1_last_q, surf_first: begin_q && first_row_q,
          surf_last: s1_last_q && last_row_q, x: own_x, score: area_q - ScoreW'(s1_mismatch_q),
          bank: bank_q - $clog2(Banks)'(take_q)}));
      CoverFollows : cover (wanted_q[0].valid && wanted_q[1].valid && wanted_q[1].last && wanted_q[0].first && !wanted_q[0].last);
      CoverFull : cover (32'(used_q) == Banks && there_q);
      CoverRefused : cover (row_taken_o && row_refused_i && pop);
      CoverStall : cover (left_q != '0 && mismatch_valid_i && !mismatch_ready_o && row_q.scoring.surface && !taken_q);
    end
  end
endmodule : slog_rules_peak_intake

bind slog_peak_intake slog_rules_peak_intake #(.ScoreBits(ScoreBits), .Banks(Banks)) u_rules (
    .own_left(left_q), .own_x(x_q), .own_bank(bank_q), .own_used(used_q), .*);
