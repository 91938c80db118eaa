// SPDX-License-Identifier: Apache-2.0
// slog_dense_lanes against counting the differing pixels of every window by brute force, in every lane.
//
// The planes' columns of MaxWindow + 1 rows are free in every clock. Assumed of the user: the bits of a window's width ago
// are those of then; above_i is the brute-force sum one row above; a clear lasts as long as the module's header asks for,
// with nothing in the planes. Then each lane's sum is the number of pixels of its window that differ.
module slog_rules_dense_lanes
  import slog_dense_pkg::*;
#(
    parameter int unsigned Lanes     = 2,
    parameter int unsigned MaxWindow = 3
) (
    input logic                     clk_i,
    input logic                     clear_i,
    input left_t                    left_i,
    input right_t                   right_i,
    input logic   [      1:0]       left_ok_i,
    input logic   [      1:0]       right_ok_i,
    input logic   [Lanes-1:0]       used_i,
    input sum_t   [Lanes-1:0]       above_i,
    input sum_t   [Lanes-1:0]       sum_o,
    input sum_t   [Lanes-1:0]       score_o,
    input logic signed [Lanes-1:0][$clog2(MaxWindow + 1):0] delta_q
);
  localparam int unsigned W    = MaxWindow;
  localparam int unsigned Deep = 3 * Lanes + W + 6;
  localparam int unsigned Long = 3 * Lanes + W + 3;  // clocks of a clear
  localparam int unsigned Free = 40;             // clocks after which the rows in the middle repeat: more than any proof's depth
  localparam int unsigned DeltaBits = $clog2(W + 1) + 1;
  typedef logic [W:0] column_t;                  // bit 0: the row that comes in; bit W: the one that leaves

  // Registers without an initial value hold anything: every clock takes the next of them.
  logic [Free-1:0][2*W-3:0] free_q;
  logic [W-2:0] left_middle, right_middle;
  column_t [Deep:0] left, right, left_q = '0, right_q = '0;  // [n]: n clocks ago
  logic [7:0] clear_q = '0;                     // clocks of a clear, up to Long
  logic ready_q = 1'b0;                         // a whole clear is over
  logic [Lanes-1:0][1:0] match, match_q;        // of lane k the left and the right window's ok, as its score needs them
  logic [2*Lanes:0][1:0] left_ok, left_ok_q;
  logic [3*Lanes:0][1:0] right_ok, right_ok_q;
  logic [Lanes-1:0] used_q;
  logic [Lanes-1:0][DeltaBits-1:0] wanted_delta;
  sum_t [Lanes-1:0] sum_q, wanted, wanted_above, wanted_score;

  // Differing pixels of lane k's window, rows `from` to `from` + W - 1, whose last column came to lane 0 `ago` clocks ago.
  function automatic sum_t count(column_t [Deep:0] l, column_t [Deep:0] r, int unsigned k, int unsigned ago,
                                 int unsigned from);
    sum_t total;
    total = '0;
    for (int unsigned i = 0; i < W; i++)
      for (int unsigned j = 0; j < W; j++)
        total += sum_t'(l[ago+2*k+i][from+j] ^ r[ago+3*k+i][from+j]);
    return total;
  endfunction

  assign {left_middle, right_middle} = clear_i ? '0 : free_q[0];
  // What lane k's delta has to be: of the window's columns, what came in less what left.
  function automatic sum_t change(column_t [Deep:0] l, column_t [Deep:0] r, int unsigned k);
    sum_t total;
    total = '0;
    for (int unsigned i = 0; i < W; i++) begin
      total += sum_t'(l[3+2*k+i][0] ^ r[3+3*k+i][0]);
      total -= sum_t'(l[3+2*k+i][W] ^ r[3+3*k+i][W]);
    end
    return total;
  endfunction

  always_comb begin
    left     = {left_q[Deep-1:0], {left_i.bits.leaving, left_middle, left_i.bits.incoming}};
    right    = {right_q[Deep-1:0], {right_i.bits.leaving, right_middle, right_i.bits.incoming}};
    left_ok  = {left_ok_q[2*Lanes-1:0], left_ok_i};
    right_ok = {right_ok_q[3*Lanes-1:0], right_ok_i};
    for (int unsigned k = 0; k < Lanes; k++) begin
      match[k]        = left_ok[2*k] & right_ok[3*k];
      wanted[k]       = count(left, right, k, 4, 0);
      wanted_above[k] = count(left, right, k, 3, 1);
      wanted_delta[k] = DeltaBits'(change(left, right, k));
      wanted_score[k] = match_q[k] != '0 && used_q[k] ? sum_q[k] : Absent;
    end
  end
  always_ff @(posedge clk_i) begin
    free_q     <= {free_q[0], free_q[Free-1:1]};
    left_q     <= left;
    right_q    <= right;
    left_ok_q  <= left_ok;
    right_ok_q <= right_ok;
    match_q    <= match;
    used_q     <= used_i;
    sum_q      <= sum_o;
    clear_q    <= !clear_i ? '0 : clear_q + 8'(32'(clear_q) < Long);
    ready_q    <= ready_q || 32'(clear_q) == Long;

    AssumeAgoLeft : assume ({left_i.bits.leaving_ago, left_i.bits.incoming_ago} == {left[W][W], left[W][0]});
    AssumeAgoRight : assume ({right_i.bits.leaving_ago, right_i.bits.incoming_ago} == {right[W][W], right[W][0]});
    AssumeAbove : assume (above_i == wanted_above);
    AssumeClear : assume (clear_i || clear_q == '0 || 32'(clear_q) == Long);
    AssumeEmpty : assume (!clear_i || (left[0] == '0 && right[0] == '0));
    AssumeBegin : assume (ready_q || clear_i);

    RulesDenseLanesDelta : assert (!ready_q || (clear_q != '0 && 32'(clear_q) != Long) || delta_q == wanted_delta);
    RulesDenseLanes : assert (!ready_q || clear_i || sum_o == wanted);
    RulesDenseLanesScore : assert (!ready_q || score_o == wanted_score);
    CoverFull : cover (ready_q && !clear_i && sum_o[Lanes-1] == sum_t'(W * W));
  end
endmodule : slog_rules_dense_lanes

bind slog_dense_lanes slog_rules_dense_lanes #(.Lanes(Lanes), .MaxWindow(MaxWindow)) u_rules (.*);
