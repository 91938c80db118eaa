// SPDX-License-Identifier: Apache-2.0
// slog_running_max against the plain maximum of a row, the first of equal values, three clocks after the row's last sample.
//
// For the induction: while a row is open, or its last sample is in stage B, the two maxima, with the update that is under
// way, hold the plain maximum; so do the maxima themselves in stage C. Two samples of one parity are never in stages A and B
// together, so the comparison of stage A is that of stage B.
module slog_rules_running_max #(
    parameter int unsigned ValueW = 3,
    parameter int unsigned IndexW = 3
) (
    input logic              clk_i,
    input logic              rst_i,
    input logic              in_valid_i,
    input logic              in_first_i,
    input logic              in_last_i,
    input logic [ValueW-1:0] in_value_i,
    input logic [IndexW-1:0] in_index_i,
    input logic              out_valid_o,
    input logic [ValueW-1:0] out_value_o,
    input logic [IndexW-1:0] out_index_o,
    input logic              odd_q,
    input logic              second_q,
    input logic [       1:0] load_q,
    input logic [       1:0] try_q,
    input logic [       1:0] above_q,
    input logic [       1:0] take,
    input logic [ValueW-1:0] b_value_q,
    input logic [IndexW-1:0] b_index_q,
    input logic [ValueW-1:0] max_q[2],
    input logic [IndexW-1:0] index_q[2],
    input logic              b_last_q,
    input logic              b_single_q,
    input logic              c_last_q,
    input logic              c_single_q
);
  typedef struct packed {
    logic              valid;
    logic [ValueW-1:0] value;
    logic [IndexW-1:0] index;
  } best_t;
  best_t best_q, best;
  best_t [2:0] wanted_q;
  logic open_q;  // a row has begun and not ended
  logic two_q;   // it has two samples or more
  logic [1:0][ValueW-1:0] b_max, c_max;
  logic [1:0][IndexW-1:0] b_index, c_index;
  logic live;    // the maxima, with stage B, are those of a row

  // The larger of two maxima, of equal ones that with the smaller index.
  function automatic logic [ValueW+IndexW-1:0] larger(logic [1:0][ValueW-1:0] value, logic [1:0][IndexW-1:0] index,
                                                      logic pair);
    return (pair && (value[1] > value[0] || (value[1] == value[0] && index[1] < index[0]))) ? {value[1], index[1]}
                                                                                            : {value[0], index[0]};
  endfunction

  always_comb begin
    for (int p = 0; p < 2; p++) begin
      b_max[p]   = take[p] ? b_value_q : max_q[p];
      b_index[p] = take[p] ? b_index_q : index_q[p];
      c_max[p]   = max_q[p];
      c_index[p] = index_q[p];
    end
  end
  assign live = open_q || wanted_q[0].valid;
  assign best = (in_first_i || in_value_i > best_q.value) ? '{valid: in_last_i, value: in_value_i, index: in_index_i}
                                                         : '{valid: in_last_i, value: best_q.value, index: best_q.index};
  always_ff @(posedge clk_i) begin
    if (in_valid_i) best_q <= best;
    if (in_valid_i) two_q <= !in_first_i;
    if (rst_i) begin
      wanted_q <= '0;
      open_q   <= 1'b0;
    end else begin
      wanted_q <= {wanted_q[1:0], in_valid_i ? best : '0};
      if (in_valid_i) open_q <= !in_last_i;
    end
    if (!rst_i) begin
      AssumeWholeRows : assume (!in_valid_i || in_first_i == !open_q);
      RulesRunningMaxValid : assert (out_valid_o == wanted_q[2].valid);
      RulesRunningMaxBest : assert (!out_valid_o || (out_value_o == wanted_q[2].value && out_index_o == wanted_q[2].index));
      RulesRunningMaxStages : assert (b_last_q == wanted_q[0].valid && c_last_q == wanted_q[1].valid);
      RulesRunningMaxOrder : assert (!live || (second_q == !two_q && b_single_q == !two_q && (two_q || odd_q)));
      RulesRunningMaxTurn : assert ((load_q | try_q) == 2'b00 || (live && (load_q | try_q) == (odd_q ? 2'b01 : 2'b10)));
      RulesRunningMaxAbove0 : assert (!try_q[0] || load_q[0] || above_q[0] == (b_value_q > max_q[0]));
      RulesRunningMaxAbove1 : assert (!try_q[1] || load_q[1] || above_q[1] == (b_value_q > max_q[1]));
      RulesRunningMaxRises : assert (!live || (b_index[0] <= b_index_q && (!two_q || b_index[1] <= b_index_q)));
      RulesRunningMaxLast : assert (!wanted_q[0].valid || {best_q.value, best_q.index} == {wanted_q[0].value, wanted_q[0].index});
      RulesRunningMaxB : assert (!live || larger(b_max, b_index, two_q) == {best_q.value, best_q.index});
      RulesRunningMaxC : assert (!wanted_q[1].valid
                                 || larger(c_max, c_index, !c_single_q) == {wanted_q[1].value, wanted_q[1].index});
      CoverSingle : cover (in_valid_i && in_first_i && in_last_i && out_valid_o);
      CoverTie : cover (in_valid_i && !in_first_i && in_last_i && in_value_i == best_q.value);
      CoverOddWins : cover (out_valid_o && out_index_o == IndexW'(1) && out_value_o != '0);
    end
  end
endmodule : slog_rules_running_max

bind slog_running_max slog_rules_running_max #(.ValueW(ValueW), .IndexW(IndexW)) u_rules (.*);
