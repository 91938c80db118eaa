// SPDX-License-Identifier: Apache-2.0
// slog_grid against the contract: job (i, j) is the command's job moved by (i * step_x, j * step_y), i fastest.
module slog_rules_grid
  import slog_pkg::*;
(
    input logic       clk_i,
    input logic       rst_i,
    input logic       job_valid_i,
    input logic       job_ready_o,
    input job_t       job_i,
    input logic [9:0] count_x_i,
    input logic [9:0] count_y_i,
    input logic [9:0] step_x_i,
    input logic [9:0] step_y_i,
    input logic       job_valid_o,
    input logic       job_ready_i,
    input job_t       job_o,
    input logic       ready_q,
    input logic       valid_q,
    input logic       laying_q,
    input logic       open_q,
    input logic       taken_q,
    input job_t       job_q,
    input logic [9:0] step_x_q,
    input logic [9:0] step_y_q,
    input logic [9:0] count_x_q,
    input logic [9:0] left_x_q,
    input logic [9:0] left_y_q,
    input logic       last_x_q,
    input logic       last_y_q
);
  job_t first_q;
  logic [9:0] count_x, count_y;      // of the command; 0 counts as 1
  logic [9:0] move_x_q, move_y_q, across_q, down_q, i_q, j_q;
  logic [9:0] x_q, y_q;              // i * step_x, j * step_y, or 1023 if that is less
  job_t wanted;
  function automatic logic [9:0] clipped(logic [9:0] from, logic [9:0] by);
    return (11'(from) + 11'(by) > 11'd1023) ? 10'd1023 : from + by;
  endfunction
  assign count_x = (count_x_i == '0) ? 10'd1 : count_x_i;
  assign count_y = (count_y_i == '0) ? 10'd1 : count_y_i;
  always_comb begin
    wanted          = first_q;
    wanted.tpl_x    = clipped(first_q.tpl_x, x_q);
    wanted.tpl_y    = clipped(first_q.tpl_y, y_q);
    wanted.search_x = clipped(first_q.search_x, x_q);
    wanted.search_y = clipped(first_q.search_y, y_q);
  end
  always_ff @(posedge clk_i) begin
    if (job_valid_i && job_ready_o) begin
      first_q  <= job_i;
      move_x_q <= step_x_i;
      move_y_q <= step_y_i;
      across_q <= count_x;
      down_q   <= count_y;
      i_q      <= '0;
      j_q      <= '0;
      x_q      <= '0;
      y_q      <= '0;
    end else if (job_valid_o) begin
      first_q.tag <= first_q.tag + 1'b1;
      if (i_q == across_q - 1'b1) begin
        i_q <= '0;
        x_q <= '0;
        j_q <= j_q + 1'b1;
        y_q <= clipped(y_q, move_y_q);
      end else begin
        i_q <= i_q + 1'b1;
        x_q <= clipped(x_q, move_x_q);
      end
    end
    if (!rst_i) begin
      RulesGridJob : assert (!job_valid_o || job_o == wanted);
      RulesGridRoom : assert (!job_valid_o || job_ready_i);
      // Inductive: what the registers hold while a command is in work.
      RulesGridKept : assert (ready_q || (job_q.tpl_x == first_q.tpl_x && job_q.search_x == first_q.search_x
                                          && step_x_q == move_x_q && step_y_q == move_y_q
                                          && (count_x_q == across_q || (count_x_q == '0 && across_q == 10'd1))));
      RulesGridLaid : assert (!valid_q || job_o == wanted);
      RulesGridLeft : assert (!valid_q || ((last_x_q || left_x_q == across_q - i_q) && (last_y_q || left_y_q == down_q - j_q)
                              && last_x_q == (i_q == across_q - 1'b1) && last_y_q == (j_q == down_q - 1'b1)));
      RulesGridInside : assert (ready_q || (i_q < across_q && j_q < down_q && across_q != '0 && down_q != '0));
      CoverLast : cover (job_valid_o && i_q == 10'd2 && j_q == 10'd1 && across_q == 10'd3 && down_q == 10'd2);
      CoverClipped : cover (job_valid_o && wanted.tpl_x == '1 && wanted.search_y == '1 && first_q.tpl_x < 10'd100);
      CoverZero : cover (job_valid_o && across_q == 10'd1 && count_x_q == '0);
    end
  end
endmodule : slog_rules_grid

bind slog_grid slog_rules_grid u_rules (.*);
