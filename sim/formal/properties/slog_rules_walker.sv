// SPDX-License-Identifier: Apache-2.0
// slog_walker against its definition: the rows taken, in order, as passes of steps with the stated fields and gaps; ring rows
// and template banks are freed in the clock of a row's last step, and only then.
module slog_rules_walker
  import slog_pkg::*, slog_fetch_pkg::*;
#(
    parameter int unsigned Pitch    = 4,
    parameter int unsigned RingRows = 32,
    parameter int unsigned RowW     = 6
) (
    input logic            clk_i,
    input logic            rst_i,
    input logic            row_valid_i,
    input logic            row_ready_o,
    input row_t            row_i,
    input step_t           step_o,
    input logic [RowW-1:0] rows_freed_o,
    input logic            bank_free_o,
    input logic            busy_o
);
  row_t [2:0] rows_q;                 // [0]: the row whose steps are output
  logic [1:0] count_q;
  logic [8:0] at_q;                   // steps of the pass before this one
  logic [5:0] pass_q;                 // passes of the row before this one
  logic [7:0] idle_q;                 // clocks without a step
  logic [RowW-1:0] freed_q;
  logic enter, leave, last, last_pass;
  logic [8:0] steps;
  logic [5:0] passes;
  logic [6:0] gap;
  row_t row;
  step_t wanted;
  assign row       = rows_q[0];
  assign enter     = row_valid_i && row_ready_o;
  assign steps     = row.steps[7] ? 9'd1 : 9'(row.steps) + 9'd2;
  assign passes    = row.passes[5] ? 6'd1 : row.passes + 6'd2;
  assign last      = at_q == steps - 1'b1;
  assign last_pass = pass_q == passes - 1'b1;
  assign leave     = step_o.valid && last && last_pass;
  assign gap       = (pass_q == '0) ? (row.gap_row[6] ? '0 : row.gap_row + 1'b1)
                                    : (row.gap_pass[6] ? '0 : row.gap_pass + 1'b1);
  assign wanted    = '{valid: 1'b1, first: at_q == '0, last: last, wide: row.wide, row_b: row.wide || !last || !row.odd,
                       bank: row.bank, tpl_step: 7'(at_q),
                       ring_row: 8'((32'(row.ring_row) + 32'(at_q) * (row.wide ? 1 : 2)) % RingRows),
                       chunk: 5'(pass_q), lanes: last_pass ? row.last_lanes : 6'(Pitch)};
  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      count_q <= '0;
      at_q    <= '0;
      pass_q  <= '0;
      idle_q  <= '1;
      freed_q <= '0;
    end else begin
      count_q <= count_q + 2'(enter) - 2'(leave);
      for (int unsigned n = 0; n < 3; n++) begin
        if (leave && n < 2) rows_q[n] <= rows_q[(n+1)%3];
        if (enter && 32'(count_q) == n + 32'(leave)) rows_q[n] <= row_i;
      end
      if (step_o.valid) begin
        idle_q <= '0;
        at_q   <= last ? '0 : at_q + 1'b1;
        if (last) pass_q <= last_pass ? '0 : pass_q + 1'b1;
      end else if (idle_q != '1) begin
        idle_q <= idle_q + 1'b1;
      end
      if (leave) freed_q <= row.free_to[RowW-1:0];
    end
    if (!rst_i) begin
      AssumeRing : assume (!row_valid_i || 32'(row_i.ring_row) < RingRows);
      RulesWalkerOwed : assert (!step_o.valid || count_q != '0);
      RulesWalkerRoom : assert (!(count_q == 2'd3 && enter && !leave) && (count_q == '0 || busy_o));
      RulesWalkerStep : assert (!step_o.valid || step_o == wanted);
      RulesWalkerWithin : assert (!step_o.valid || at_q == '0 || idle_q == '0);
      RulesWalkerGap : assert (!step_o.valid || at_q != '0 || ((pass_q == '0) ? idle_q >= 8'(gap) : idle_q == 8'(gap)));
      RulesWalkerFrees : assert (rows_freed_o == (leave ? row.free_to[RowW-1:0] : freed_q)
                                 && bank_free_o == (leave && row.final_row));
      CoverSecondRow : cover (step_o.valid && count_q == 2'd2 && at_q == 9'd1 && last);
      CoverNoGap : cover (leave && idle_q == '0 && enter);
      CoverThirdPass : cover (step_o.valid && pass_q == 6'd2 && last_pass && !row.gap_pass[6]);
      CoverOdd : cover (step_o.valid && !step_o.row_b && at_q == 9'd2);
    end
  end
endmodule : slog_rules_walker

bind slog_walker slog_rules_walker #(.Pitch(Pitch), .RingRows(RingRows), .RowW(RowW)) u_rules (.*);
