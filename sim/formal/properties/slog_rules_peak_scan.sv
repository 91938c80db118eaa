// SPDX-License-Identifier: Apache-2.0
// slog_peak_scan against its definition: the columns of an order, one a clock; which of them are next to the best; the three
// rows' scores there; and the greatest score elsewhere, ten clocks after the last column's read.
module slog_rules_peak_scan
  import slog_pkg::*, slog_peak_pkg::*;
#(
    parameter int unsigned Banks = 4
) (
    input logic                         clk_i,
    input logic                         rst_i,
    input logic                         order_valid_i,
    input scan_t                        order_i,
    input logic [Banks-1:0]             read_o,
    input logic [9:0]                   read_x_o,
    input logic [Banks-1:0][ScoreW-1:0] data_i,
    input logic                         near_first_o,
    input logic                         near_end_o,
    input logic                         near_west_o,
    input logic                         near_centre_o,
    input logic                         near_east_o,
    input maybe_t                       near_above_o,
    input maybe_t                       near_middle_o,
    input maybe_t                       near_below_o,
    input logic                         far_valid_o,
    input maybe_t                       far_o
);
  typedef struct packed {
    logic       valid;
    scan_t      order;
    logic [9:0] x;
    logic       last;
    logic [1:0] bank;  // of the row scanned
  } column_t;
  typedef struct packed {
    logic   valid;
    maybe_t far;
  } far_t;
  scan_t order_q;
  logic open_q, late_q;              // columns are to come; the only column is read once more first
  logic [9:0] x_q;
  logic [1:0] bank_q;
  column_t now;                      // the column that is read in this clock
  column_t [2:0] past_q;             // [k]: k + 1 clocks ago
  maybe_t above, middle, below, above_q, middle_q, below_q, greatest_q, value;
  far_t [7:0] far_q;
  logic beside;

  assign now = '{valid: open_q && !late_q, order: order_q, x: x_q, last: order_q.only || x_q == order_q.last_x,
                 bank: bank_q};
  // The data of the column read two clocks ago.
  assign above  = (past_q[1].order.fresh && past_q[1].order.above) ? {1'b1, data_i[past_q[1].bank-2'd1]} : '0;
  assign middle = (past_q[1].order.fresh && past_q[1].order.middle) ? {1'b1, data_i[past_q[1].bank]} : '0;
  assign below  = (past_q[1].order.fresh && past_q[1].order.below) ? {1'b1, data_i[past_q[1].bank+2'd1]} : '0;
  function automatic maybe_t larger(maybe_t a, maybe_t b);
    return (a > b) ? a : b;
  endfunction
  assign beside = 11'(past_q[2].x) + 11'd1 >= 11'(past_q[2].order.best_x)
                  && 11'(past_q[2].x) <= 11'(past_q[2].order.best_x) + 11'd1;
  assign value  = beside ? '0 : larger(larger(above_q, middle_q), below_q);

  always_ff @(posedge clk_i) begin
    {above_q, middle_q, below_q} <= {above, middle, below};
    if (rst_i) begin
      open_q <= 1'b0;
      bank_q <= 2'd3;
      past_q <= '0;
      far_q  <= '0;
    end else begin
      past_q <= {past_q[1:0], now};
      far_q  <= {far_q[6:0], far_t'{valid: past_q[2].valid && past_q[2].last,
                                    far: (past_q[2].x == '0) ? value : larger(greatest_q, value)}};
      if (past_q[2].valid) greatest_q <= (past_q[2].x == '0) ? value : larger(greatest_q, value);
      if (order_valid_i) begin
        order_q <= order_i;
        open_q  <= 1'b1;
        late_q  <= order_i.only;
        x_q     <= '0;
        bank_q  <= bank_q + 1'b1;
      end else begin
        late_q <= 1'b0;
        if (now.valid) begin
          x_q    <= x_q + 1'b1;
          open_q <= !now.last;
        end
      end
    end
    if (!rst_i) begin
      AssumeShort : assume (!order_valid_i || (order_i.only == (!order_i.fresh || !order_i.middle || order_i.last_x == '0)
          && order_i.brief == (!order_i.fresh || !order_i.middle || order_i.last_x <= 10'd1)
          && (order_i.middle || order_i.best_x == '0)));
      RulesPeakScanRead : assert (!now.valid || !order_q.fresh || (read_x_o == x_q
          && read_o == ((Banks'(order_q.middle) << bank_q) | (Banks'(order_q.above) << 2'(bank_q - 2'd1))
                        | (Banks'(order_q.below) << 2'(bank_q + 2'd1)))));
      RulesPeakScanNear : assert ({near_first_o, near_west_o, near_centre_o, near_east_o}
          == ({4{past_q[2].valid && past_q[2].order.fresh}}
              & {past_q[2].x == '0, 11'(past_q[2].x) + 11'd1 == 11'(past_q[2].order.best_x),
                 past_q[2].x == past_q[2].order.best_x, 11'(past_q[2].x) == 11'(past_q[2].order.best_x) + 11'd1}));
      RulesPeakScanEnd : assert (near_end_o == (past_q[2].valid && past_q[2].last && past_q[2].order.last));
      RulesPeakScanData : assert (!past_q[2].valid || !past_q[2].order.fresh
                                  || {near_above_o, near_middle_o, near_below_o} == {above_q, middle_q, below_q});
      RulesPeakScanFar : assert (far_valid_o == far_q[6].valid && (!far_valid_o || far_o == far_q[6].far));
      CoverFar : cover (far_valid_o && far_o[ScoreW]);
      CoverFollows : cover (now.valid && now.last && order_valid_i && !now.order.only && !order_i.only);
      CoverOnly : cover (far_valid_o && past_q[2].valid && past_q[2].order.only && past_q[2].order.fresh);
    end
  end
endmodule : slog_rules_peak_scan

bind slog_peak_scan slog_rules_peak_scan #(.Banks(Banks)) u_rules (.*);
