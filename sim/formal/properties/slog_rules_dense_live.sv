// SPDX-License-Identifier: Apache-2.0
// slog_dense_live against what the cameras showed since the pass began, with captures that do all that slog_capture's may.
//
// there_o only with evidence that both frames have their next row; whole_o only when both are whole; lost_o as soon as one
// breaks off, and for good.
module slog_rules_dense_live
  import slog_store_pkg::*;
(
    input logic                   clk_i,
    input logic                   rst_i,
    input logic                   begin_i,
    input logic                   reading_i,
    input logic                   live_i,
    input logic        [1:0][7:0] slots_i,
    input logic signed      [9:0] down_i,
    input logic                   row_i,
    input progress_t [1:0]        progress_i,
    input logic             [7:0] slot_valid_i,
    input logic             [1:0] here_o,
    input logic             [1:0] keep_o,
    input logic                   there_o,
    input logic                   whole_o,
    input logic                   lost_o
);
  localparam int unsigned Latency = 4;  // from progress_i to there_o, whole_o and lost_o
  progress_t [1:0] before_q;            // progress_i and slot_valid_i of the clock before
  logic [7:0] valid_q;
  logic started_q, reading_q, lost_q, there_q;
  logic [26:0] job_q;
  logic [3:0] age_q, since_q;           // clocks since begin_i, since row_i, up to 15
  logic [1:0] low_q;                    // clocks for which reading_i and rst_i were low, up to 3
  logic [9:0] y_q;
  logic signed [11:0] r;
  // Evidence of a plane: rows seen at most, a frame at the begin, one that became whole; and the frame broke off.
  logic [1:0][9:0] best_q;
  logic [1:0] had_q, done_q, asked, writes, wrote, ends;
  logic [1:0][9:0] rows;
  logic [Latency:0][1:0] broke_q;       // [n]: n clocks before the last
  assign r    = 12'(signed'({2'b00, y_q})) - 12'(down_i);
  always_comb begin
    for (int unsigned p = 0; p < 2; p++) begin
      asked[p]  = 1'b0;
      writes[p] = 1'b0;
      wrote[p]  = 1'b0;
      ends[p]   = 1'b0;
      rows[p]   = '0;
      for (int unsigned c = 0; c < 2; c++) begin
        if (before_q[c].held && slots_i[p][before_q[c].slot]) begin
          asked[p]  = 1'b1;
          wrote[p]  = before_q[c].writing;
          ends[p]   = before_q[c].done;
          rows[p]   = before_q[c].writing ? before_q[c].rows : '0;
          writes[p] = progress_i[c].writing;
        end
      end
    end
  end
  always_ff @(posedge clk_i) begin
    started_q <= !rst_i;
    reading_q <= reading_i && !rst_i;
    before_q  <= progress_i;
    valid_q   <= slot_valid_i;
    there_q   <= there_o;
    job_q     <= {live_i, slots_i, down_i};
    lost_q    <= lost_o && reading_i && !rst_i;
    age_q     <= begin_i || rst_i ? '0 : age_q + 4'(age_q != '1);
    since_q   <= begin_i || row_i ? 4'd1 : since_q + 4'(since_q != '1);
    low_q     <= reading_i || rst_i ? '0 : low_q + 2'(low_q != '1);
    y_q       <= begin_i ? '0 : y_q + 10'(row_i);
    for (int unsigned p = 0; p < 2; p++) begin
      best_q[p]  <= begin_i || rows[p] > best_q[p] ? rows[p] : best_q[p];
      had_q[p]   <= begin_i ? !asked[p] && (slots_i[p] & valid_q) != '0 : had_q[p];
      done_q[p]  <= ends[p] || (done_q[p] && !begin_i);
      broke_q[0][p] <= reading_i && !begin_i && age_q != '0 && wrote[p] && !ends[p] && !writes[p] &&
                       here_o[p] && !had_q[p] && !done_q[p];
    end
    broke_q[Latency:1] <= broke_q[Latency-1:0];
    if (rst_i || begin_i) broke_q <= '0;
    if (!rst_i) begin
      AssumePause : assume (!begin_i || low_q >= 2'd3);
      AssumeReading : assume (begin_i == (reading_i && !reading_q));
      AssumeRow : assume (!row_i || (reading_i && reading_q && since_q >= 4'd4 && there_q));
    end
    if (!rst_i && started_q) begin
      AssumeJob : assume (!reading_q || job_q == {live_i, slots_i, down_i});
      AssumeSlots : assume ($onehot0(slots_i[0]) && $onehot0(slots_i[1]));
      AssumeHeight : assume (y_q < 10'd500);
      AssumeOne : assume (!(progress_i[0].held && progress_i[1].held && progress_i[0].slot == progress_i[1].slot));

      if (reading_q && live_i && age_q >= 4'(Latency) && since_q >= 4'(Latency)) begin
        RulesDenseLiveLeft : assert (!there_o || had_q[0] || done_q[0] || best_q[0] > y_q);
        RulesDenseLiveRight : assert (!there_o || had_q[1] || done_q[1] || r < 12'sd0 || 12'(best_q[1]) > unsigned'(r));
        RulesDenseLiveWhole : assert (!whole_o || (had_q | done_q) == 2'b11);
        RulesDenseLiveBroken : assert (lost_o || broke_q[Latency] == '0);
        RulesDenseLiveOneEnd : assert (!(whole_o && lost_o));
      end
      RulesDenseLiveAbsent : assert (!(reading_q && live_i) || ((!here_o[0] || slots_i[0] != '0) &&
                                                                (!here_o[1] || slots_i[1] != '0)));
      RulesDenseLiveStays : assert (!(reading_q && lost_q) || begin_i || !reading_i || lost_o);
      RulesDenseLiveFree : assert (live_i || (keep_o == 2'b11));
      CoverThere : cover (there_o && live_i && reading_q && y_q == 10'd1 && had_q == '0 && done_q == '0 && age_q >= 4'd8);
      CoverWhole : cover (whole_o && live_i && reading_q && had_q == 2'b01);
      CoverBroken : cover (lost_o && reading_q && broke_q[Latency] != '0);
      CoverAwaited : cover (reading_q && live_i && here_o == 2'b11 && keep_o == 2'b00 && age_q == 4'd9);
    end
  end
  for (genvar c = 0; c < 2; c++) begin : g_camera
    always_ff @(posedge clk_i) begin
      if (!rst_i && started_q) begin
        AssumeHeld : assume (progress_i[c].held || (!progress_i[c].writing && !progress_i[c].done));
        AssumeDone : assume (!progress_i[c].done || progress_i[c].writing);
        AssumeGone : assume (!before_q[c].done || !progress_i[c].held);
        AssumeSame : assume (!(progress_i[c].writing && before_q[c].writing) ||
                             (progress_i[c].slot == before_q[c].slot && progress_i[c].rows >= before_q[c].rows));
        // A frame begins to be written only after the request was seen.
        AssumeBegins : assume (!(progress_i[c].writing && !before_q[c].writing) || (before_q[c].held &&
                               progress_i[c].slot == before_q[c].slot));
      end
    end
  end
endmodule : slog_rules_dense_live

bind slog_dense_live slog_rules_dense_live u_rules (.*);
