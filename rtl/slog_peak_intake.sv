// Takes scores row by row: mismatches to scores, each row into the next of the row banks, surface scores out.
//
//   0  mismatch_valid_i, mismatch_ready_o: position known        1  mismatch and area registered        2  score: outputs
// Latency    : score_* and surf_valid_o two clocks after the mismatch is taken; score = area - mismatch.
// Throughput : one score per clock, also from row to row and job to job; at most one row in two clocks.
// Stalls     : a row begins when a bank is free (banks are reused in turn; released_i banks return). A bank is
//              released when the last scan that reads it starts: scans never pause and scores come at most one per
//              clock, so a new row follows the scan and never overtakes it. Surface scores wait for surf_ok_i, which must
//              leave room for four more.
`include "slog_assert.svh"
module slog_peak_intake
  import slog_pkg::*;
  import slog_peak_pkg::*;
#(
    parameter int unsigned ScoreBits = 15,
    parameter int unsigned Banks     = 4
) (
    input  logic                 clk_i,
    input  logic                 rst_i,
    // Rows to come.
    input  logic                 row_valid_i,
    output logic                 row_ready_o,
    input  logic                 row_refused_i,
    input  logic [9:0]           row_last_x_i,
    input  logic                 row_first_i,    // of its job
    input  logic                 row_last_i,
    input  scoring_t             scoring_i,
    input  logic [1:0]           released_i,    // banks that return in this clock
    // Scores.
    input  logic                 mismatch_valid_i,
    output logic                 mismatch_ready_o,
    input  logic [ScoreBits-1:0] mismatch_i,
    // Scores with their place.
    output logic                 score_valid_o,
    output logic                 score_first_o,  // of its row
    output logic                 score_last_o,
    output logic [9:0]           score_x_o,
    output logic [ScoreW-1:0]    score_o,
    output logic [Banks-1:0]     bank_o,         // one-hot; 0 unless score_valid_o
    // Marks for the surface stream.
    output logic                 surf_valid_o,
    output logic                 surf_first_o,   // of its job
    output logic                 surf_last_o,
    input  logic                 surf_ok_i
);
  localparam int unsigned UsedW = $clog2(Banks + 1);

  // The row that is coming in.
  logic run_q, begin_q, end_q, first_row_q, last_row_q;  // begin_q, end_q: the next score is the row's first, last
  logic [9:0] x_q, left_q;
  scoring_t scoring_q;
  logic [Banks-1:0] bank_q;
  // Banks.
  logic [UsedW-1:0] used_q;
  logic open_q;  // a bank is free
  logic pop, close, take;

  assign mismatch_ready_o = run_q && (surf_ok_i || !scoring_q.surface);
  assign pop              = mismatch_valid_i && mismatch_ready_o;
  assign close            = pop && end_q;
  assign row_ready_o      = open_q && (!run_q || close);
  assign take             = row_valid_i && row_ready_o;

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      run_q  <= 1'b0;
      used_q <= '0;
      open_q <= 1'b0;
      bank_q <= Banks'(1) << (Banks - 1);
    end else begin
      if (take) run_q <= !row_refused_i;
      else if (close) run_q <= 1'b0;
      if (take) bank_q <= {bank_q[Banks-2:0], bank_q[Banks-1]};
      used_q <= used_q + UsedW'(take) - UsedW'(released_i);
      open_q <= !take && (used_q != UsedW'(Banks) || released_i != '0);
    end
  end

  always_ff @(posedge clk_i) begin
    if (take) begin
      x_q         <= '0;
      left_q      <= row_last_x_i;
      begin_q     <= 1'b1;
      end_q       <= row_last_x_i == '0;
      first_row_q <= row_first_i;
      last_row_q  <= row_last_i;
      scoring_q   <= scoring_i;
    end else if (pop) begin
      x_q     <= x_q + 10'd1;
      left_q  <= left_q - 10'd1;
      begin_q <= 1'b0;
      end_q   <= left_q == 10'd1;
    end
  end

  // Stage 1.
  logic s1_valid_q, s1_first_q, s1_last_q, s1_surf_q, s1_surf_first_q, s1_surf_last_q;
  logic [9:0] s1_x_q;
  logic [Banks-1:0] s1_bank_q;
  logic [ScoreBits-1:0] s1_mismatch_q;
  logic [ScoreW-1:0] s1_area_q;
  // Stage 2.
  logic s2_valid_q, s2_first_q, s2_last_q, s2_surf_q, s2_surf_first_q, s2_surf_last_q;
  logic [9:0] s2_x_q;
  logic [Banks-1:0] s2_bank_q;
  logic [ScoreW-1:0] s2_score_q;

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      s1_valid_q <= 1'b0;
      s1_surf_q  <= 1'b0;
      s2_valid_q <= 1'b0;
      s2_surf_q  <= 1'b0;
      s2_bank_q  <= '0;
    end else begin
      s1_valid_q <= pop;
      s1_surf_q  <= pop && scoring_q.surface;
      s2_valid_q <= s1_valid_q;
      s2_surf_q  <= s1_surf_q;
      s2_bank_q  <= s1_valid_q ? s1_bank_q : '0;
    end
  end

  always_ff @(posedge clk_i) begin
    if (pop) begin
      s1_first_q      <= begin_q;
      s1_last_q       <= end_q;
      s1_surf_first_q <= begin_q && first_row_q;
      s1_surf_last_q  <= end_q && last_row_q;
      s1_x_q          <= x_q;
      s1_bank_q       <= bank_q;
      s1_mismatch_q   <= mismatch_i;
      s1_area_q       <= scoring_q.area;
    end
    if (s1_valid_q) begin
      s2_first_q      <= s1_first_q;
      s2_last_q       <= s1_last_q;
      s2_surf_first_q <= s1_surf_first_q;
      s2_surf_last_q  <= s1_surf_last_q;
      s2_x_q          <= s1_x_q;
      s2_score_q      <= s1_area_q - ScoreW'(s1_mismatch_q);
    end
  end

  assign score_valid_o = s2_valid_q;
  assign score_first_o = s2_first_q;
  assign score_last_o  = s2_last_q;
  assign score_x_o     = s2_x_q;
  assign score_o       = s2_score_q;
  assign bank_o        = s2_bank_q;
  assign surf_valid_o  = s2_surf_q;
  assign surf_first_o  = s2_surf_first_q;
  assign surf_last_o   = s2_surf_last_q;

  `SLOG_ASSERT(SlogPeakIntakeBanks, used_q <= UsedW'(Banks) && UsedW'(released_i) <= used_q)
  `SLOG_ASSERT(SlogPeakIntakeArea, !s1_valid_q || ScoreW'(s1_mismatch_q) <= s1_area_q)
endmodule : slog_peak_intake
