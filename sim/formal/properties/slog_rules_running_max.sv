// SPDX-License-Identifier: Apache-2.0
// slog_running_max against the plain maximum of a row, the first of equal values, three clocks after the row's last sample.
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
    input logic [IndexW-1:0] out_index_o
);
  typedef struct packed {
    logic              valid;
    logic [ValueW-1:0] value;
    logic [IndexW-1:0] index;
  } best_t;
  best_t best_q, best;
  best_t [2:0] wanted_q;
  logic open_q;  // a row has begun and not ended
  assign best = (in_first_i || in_value_i > best_q.value) ? '{valid: in_last_i, value: in_value_i, index: in_index_i}
                                                         : '{valid: in_last_i, value: best_q.value, index: best_q.index};
  always_ff @(posedge clk_i) begin
    if (in_valid_i) best_q <= best;
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
      CoverSingle : cover (in_valid_i && in_first_i && in_last_i && out_valid_o);
      CoverTie : cover (in_valid_i && !in_first_i && in_last_i && in_value_i == best_q.value);
      CoverOddWins : cover (out_valid_o && out_index_o == IndexW'(1) && out_value_o != '0);
    end
  end
endmodule : slog_rules_running_max

bind slog_running_max slog_rules_running_max #(.ValueW(ValueW), .IndexW(IndexW)) u_rules (.*);
