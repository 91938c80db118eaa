// SPDX-License-Identifier: Apache-2.0
// Takes mismatches row by row and turns them into scores: each row is written to the next row bank; scores of jobs with
// surface are marked for the surface stream.
//
//   0  mismatch_valid_i, mismatch_ready_o, end of row    1  mismatch, column and bank registered    2  score: outputs
// Handshake  : row_coming_i: a row can be taken in the next clock; row_taken_o takes it. The inputs that describe the
//              row are stable for one clock more.
// Latency    : score_* and surf_valid_o two clocks after the mismatch is taken; score = area - mismatch.
// Throughput : one score per clock, also from row to row and job to job; at most one row in two clocks.
// Stalls     : a row begins when a bank is free (banks are used in turn; released_i banks become free). A bank is
//              released when the last scan that reads it starts: scans never pause and at most one score arrives per
//              clock, so a new row follows the scan and never overtakes it. A surface score is taken only if surf_ok_i
//              was high in the clock before; surf_ok_i must leave room for four more scores.
// Reset      : rst_i is held for 1 clock or more.
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
    // The next row.
    input  logic                 row_coming_i,
    output logic                 row_taken_o,
    input  logic                 row_refused_i,
    input  logic [9:0]           row_last_x_i,
    input  logic                 row_first_i,    // of its job
    input  logic                 row_last_i,
    input  scoring_t             scoring_i,
    input  logic [1:0]           released_i,    // number of banks that become free in this clock
    // Scores.
    input  logic                 mismatch_valid_i,
    output logic                 mismatch_ready_o,
    input  logic [ScoreBits-1:0] mismatch_i,
    // Scores with their column and bank.
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

  // The present row, as far as stage 0 needs it. Flags have inverted copies, to limit the fan-out of the logic behind
  // mismatch_valid_i.
  logic idle_q, run_q;      // no row is present; a row is present
  logic go_q, halt_q;       // a score is taken if it is valid; !go_q
  logic end_q, near_q;      // the next score is the row's last; the last but one
  logic more_q;             // !end_q
  logic surface_q;
  logic ending_q, going_q;  // go_q && end_q; !ending_q
  logic [9:0] left_q;       // scores after the next one
  logic pop, fill, take, move, next, row_go, run_go, row_ends, ending;
  // Banks.
  logic [UsedW-1:0] used_q;  // banks in use, without the row taken in the clock before (take_q)
  logic take_q;
  logic open_q;  // a bank is free and a row is waiting

  assign mismatch_ready_o = go_q;
  assign pop              = mismatch_valid_i && go_q;
  assign fill             = !run_q || (mismatch_valid_i && ending_q);
  assign take             = open_q && (idle_q || (mismatch_valid_i && !going_q));
  assign move             = !run_q || (mismatch_valid_i && !halt_q);
  assign row_taken_o      = take;
  assign next             = !run_q || !more_q;
  // row_go: the waiting row would take a score in the next clock. run_go: the present row would.
  assign row_go           = !row_refused_i && (surf_ok_i || !scoring_i.surface);
  assign row_ends         = open_q && row_go && scoring_i.one;
  assign run_go           = surf_ok_i || !surface_q;

  // mismatch_valid_i is late, so it selects in the last level of logic.
  always_comb begin
    if (mismatch_valid_i) ending = (idle_q || ending_q) ? row_ends : run_go && (end_q || (go_q && near_q));
    else ending = idle_q ? row_ends : run_go && end_q;
  end

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      idle_q   <= 1'b1;
      run_q    <= 1'b0;
      go_q     <= 1'b0;
      halt_q   <= 1'b1;
      ending_q <= 1'b0;
      going_q  <= 1'b1;
      open_q   <= 1'b0;
      used_q   <= '0;
    end else begin
      // With fill, the waiting row is taken if open_q is set.
      idle_q   <= fill && !(open_q && !row_refused_i);
      run_q    <= !fill || (open_q && !row_refused_i);
      go_q     <= fill ? open_q && row_go : run_go;
      halt_q   <= !(fill ? open_q && row_go : run_go);
      ending_q <= ending;
      going_q  <= !ending;
      open_q   <= row_coming_i && !take && (used_q != UsedW'(Banks) - UsedW'(take_q) || released_i != '0);
      used_q   <= used_q + UsedW'(take_q) - UsedW'(released_i);
    end
  end

  // The row inputs are loaded, valid or not, when a row may be taken; while idle in every clock.
  always_ff @(posedge clk_i) begin
    if (move) begin
      end_q  <= next ? scoring_i.one : near_q;
      more_q <= next ? !scoring_i.one : !near_q;
      near_q <= next ? scoring_i.two : left_q == 10'd2;
      left_q <= next ? row_last_x_i : left_q - 10'd1;
      if (next) surface_q <= scoring_i.surface;
    end
  end

  // Stage 1: the row's data are loaded one clock after row_taken_o, and its first score is in stage 1 two clocks after
  // row_taken_o at the earliest.
  logic s1_valid_q, s1_last_q, begin_q, first_row_q, last_row_q, surface_row_q;
  logic [ScoreBits-1:0] s1_mismatch_q;
  logic [9:0] x_q;
  logic [ScoreW-1:0] area_q;
  logic [Banks-1:0] bank_q;
  // Stage 2.
  logic s2_valid_q, s2_first_q, s2_last_q, s2_surf_q, s2_surf_first_q, s2_surf_last_q;
  logic [9:0] s2_x_q;
  logic [Banks-1:0] s2_bank_q;
  logic [ScoreW-1:0] s2_score_q;

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      take_q     <= 1'b0;
      bank_q     <= Banks'(1) << (Banks - 1);
      s1_valid_q <= 1'b0;
      s2_valid_q <= 1'b0;
      s2_surf_q  <= 1'b0;
      s2_bank_q  <= '0;
    end else begin
      take_q     <= take;
      if (take_q) bank_q <= {bank_q[Banks-2:0], bank_q[Banks-1]};
      s1_valid_q <= pop;
      s2_valid_q <= s1_valid_q;
      s2_surf_q  <= s1_valid_q && surface_row_q;
      s2_bank_q  <= {Banks{s1_valid_q}} & bank_q;
    end
  end

  always_ff @(posedge clk_i) begin
    s1_last_q     <= end_q;
    s1_mismatch_q <= mismatch_i;
    if (take_q) begin
      x_q           <= '0;
      begin_q       <= 1'b1;
      first_row_q   <= row_first_i;
      last_row_q    <= row_last_i;
      surface_row_q <= scoring_i.surface;
      area_q        <= scoring_i.area;
    end else if (s1_valid_q) begin
      x_q     <= x_q + 10'd1;
      begin_q <= 1'b0;
    end
    if (s1_valid_q) begin
      s2_first_q      <= begin_q;
      s2_last_q       <= s1_last_q;
      s2_surf_first_q <= begin_q && first_row_q;
      s2_surf_last_q  <= s1_last_q && last_row_q;
      s2_x_q          <= x_q;
      s2_score_q      <= area_q - ScoreW'(s1_mismatch_q);
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

  `SLOG_ASSERT(SlogPeakIntakeBanks, used_q + UsedW'(take_q) <= UsedW'(Banks)
                                    && UsedW'(released_i) <= used_q + UsedW'(take_q))
  `SLOG_ASSERT(SlogPeakIntakeCopies, run_q == !idle_q && halt_q == !go_q && going_q == !ending_q
                                     && (idle_q || ending_q == (go_q && end_q)))
  `SLOG_ASSERT(SlogPeakIntakeEnd, idle_q || (end_q == (left_q == '0) && more_q == !end_q
                                             && near_q == (left_q == 10'd1)))
  `SLOG_ASSERT(SlogPeakIntakeArea, !s1_valid_q || ScoreW'(s1_mismatch_q) <= area_q)
  `SLOG_ASSERT_INIT(SlogPeakIntakeSizes, ScoreBits <= ScoreW && Banks >= 2)
  `SLOG_PAST(past_row, {row_first_i, row_last_i, scoring_i})
  `SLOG_ASSERT(SlogPeakIntakeRowStays, !take_q || {row_first_i, row_last_i, scoring_i} == past_row)
  `SLOG_ASSERT_NEXT(SlogPeakIntakeRowsApart, row_taken_o, !row_taken_o)
  `SLOG_ASSERT(SlogPeakIntakeBank, score_valid_o ? $onehot(bank_o) : bank_o == '0)
endmodule : slog_peak_intake
