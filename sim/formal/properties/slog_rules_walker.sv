// SPDX-License-Identifier: Apache-2.0
// slog_walker against its definition, a counter of gaps, steps and passes that counts up from 0: every clock's step and
// its fields, when a row is taken, and when its ring rows and its template bank are freed.
//
// The definition runs two clocks ahead of step_o. The Inductive assertions tie the RTL's counters, which count down to a
// sign bit, to those of the definition, so that the proof holds for rows of any length.
module slog_rules_walker
  import slog_pkg::*, slog_fetch_pkg::*;
#(
    parameter int unsigned Pitch       = 4,
    parameter int unsigned RingRows    = 32,
    parameter int unsigned DrainClocks = 4,
    parameter int unsigned RowW        = 6,
    parameter int unsigned DrainW      = 3
) (
    input logic              clk_i,
    input logic              rst_i,
    input logic              row_valid_i,
    input logic              row_ready_o,
    input row_t              row_i,
    input step_t             step_o,
    input logic [RowW-1:0]   rows_freed_o,
    input logic              bank_free_o,
    input logic              busy_o,
    input row_t              row_q,
    input logic              paired_q,
    input logic              active_q,
    input logic              stepping_q,
    input logic              last_q,
    input logic              last_pass_q,
    input logic [6:0]        gap_q,
    input logic [7:0]        steps_q,
    input logic [5:0]        passes_q,
    input logic [RowW-2:0]   ring_q,
    input logic              first_q,
    input logic [6:0]        tpl_step_q,
    input logic [4:0]        chunk_q,
    input logic [DrainW-1:0] drain_q,
    input int unsigned       clocks_since_step
);
  // Clocks of a gap, steps of a pass, passes of a row; a set sign bit says none, one, one.
  function automatic logic [7:0] gap_of(logic [6:0] field);
    return field[6] ? 8'd0 : 8'(field) + 8'd1;
  endfunction
  function automatic logic [8:0] steps_of(row_t row);
    return row.steps[7] ? 9'd1 : 9'(row.steps) + 9'd2;
  endfunction
  function automatic logic [6:0] passes_of(row_t row);
    return row.passes[5] ? 7'd1 : 7'(row.passes) + 7'd2;
  endfunction

  // [0]: of the definition; [1], [2]: one and two clocks later.
  logic [2:0] active, valid;
  row_t row[3];
  logic [8:0] at[3];
  logic [6:0] pass[3];
  logic active_r_q;
  row_t row_r_q;
  logic [7:0] gap_r_q;
  logic [8:0] at_r_q;
  logic [6:0] pass_r_q;
  logic [2:1] active_p_q, valid_p_q;
  row_t row_p_q[3];
  logic [8:0] at_p_q[3];
  logic [6:0] pass_p_q[3];
  logic last, last_pass, ready, leave, last_out, last_pass_out;
  logic [RowW-1:0] freed_q;
  step_t wanted;

  assign last      = at_r_q == steps_of(row_r_q) - 1'b1;
  assign last_pass = pass_r_q == passes_of(row_r_q) - 1'b1;
  assign ready     = !active_r_q || (gap_r_q == '0 && last && last_pass);
  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      active_r_q <= 1'b0;
    end else if (ready) begin
      active_r_q <= row_valid_i;
      row_r_q    <= row_i;
      gap_r_q    <= gap_of(row_i.gap_row);
      at_r_q     <= '0;
      pass_r_q   <= '0;
    end else if (gap_r_q != '0) begin
      gap_r_q <= gap_r_q - 1'b1;
    end else if (!last) begin
      at_r_q <= at_r_q + 1'b1;
    end else begin
      at_r_q   <= '0;
      pass_r_q <= pass_r_q + 1'b1;
      gap_r_q  <= gap_of(row_r_q.gap_pass);
    end
  end
  always_comb begin
    active = {active_p_q, active_r_q};
    valid  = {valid_p_q, active_r_q && gap_r_q == '0};
    row    = row_p_q;
    at     = at_p_q;
    pass   = pass_p_q;
    row[0]  = row_r_q;
    at[0]   = at_r_q;
    pass[0] = pass_r_q;
  end
  always_ff @(posedge clk_i) begin
    active_p_q <= rst_i ? '0 : active[1:0];
    valid_p_q  <= rst_i ? '0 : valid[1:0];
    for (int unsigned n = 1; n < 3; n++) begin
      row_p_q[n]  <= row[n-1];
      at_p_q[n]   <= at[n-1];
      pass_p_q[n] <= pass[n-1];
    end
  end

  assign last_out      = at[2] == steps_of(row[2]) - 1'b1;
  assign last_pass_out = pass[2] == passes_of(row[2]) - 1'b1;
  assign leave         = valid[2] && last_out && last_pass_out;
  assign wanted = '{valid: 1'b1, first: at[2] == '0, last: last_out, wide: row[2].wide,
                    row_b: row[2].wide || !last_out || !row[2].odd, bank: row[2].bank, tpl_step: 7'(at[2]),
                    ring_row: 8'((32'(row[2].ring_row) + (32'(at[2]) << !row[2].wide)) % RingRows),
                    chunk: 5'(pass[2]), lanes: last_pass_out ? row[2].last_lanes : 6'(Pitch)};
  always_ff @(posedge clk_i) begin
    if (rst_i) freed_q <= '0;
    else if (leave) freed_q <= row[2].free_to[RowW-1:0];
    if (!rst_i) begin
      AssumeRing : assume (!row_valid_i || 32'(row_i.ring_row) < RingRows);
      RulesWalkerReady : assert (row_ready_o == ready);
      RulesWalkerStep : assert (step_o.valid == valid[2] && (!step_o.valid || step_o == wanted));
      RulesWalkerBusy : assert (busy_o == (active[0] || valid[2:1] != '0));
      RulesWalkerFrees : assert (rows_freed_o == (leave ? row[2].free_to[RowW-1:0] : freed_q)
                                 && bank_free_o == (leave && row[2].final_row));
      InductiveRow : assert (active_q == active_r_q
                             && (!active_q || (row_q == row_r_q && paired_q == !row_r_q.wide
                                               && 32'(row_r_q.ring_row) < RingRows)));
      InductiveGap : assert (!active_q || (stepping_q == (gap_r_q == '0)
                                           && (stepping_q || (gap_r_q == 8'(gap_q) + 8'd1 && !gap_q[6]))));
      InductiveSteps : assert (!active_q || (steps_q == row_r_q.steps - 8'(at_r_q) && last_q == last
                                             && at_r_q < steps_of(row_r_q) && (stepping_q || at_r_q == '0)));
      InductivePasses : assert (!active_q || (passes_q == row_r_q.passes - 6'(pass_r_q) && last_pass_q == last_pass
                                              && pass_r_q < passes_of(row_r_q)));
      InductiveRing : assert (!active_q || 32'(ring_q) == (32'(row_r_q.ring_row) + (32'(at_r_q) << !row_r_q.wide)) % RingRows);
      InductiveSecond : assert (!active[1] || (first_q == (at[1] == '0) && tpl_step_q == 7'(at[1])
                                               && chunk_q == 5'(pass[1])));
      InductiveDrain : assert (clocks_since_step <= DrainClocks && (drain_q[DrainW-1]
                                                 ? clocks_since_step + 1 >= DrainClocks
                                                 : 32'(drain_q) + clocks_since_step + 2 >= DrainClocks));
      CoverSecondRow : cover (step_o.valid && valid[1] && row[1].bank != row[2].bank);
      CoverNoGap : cover (leave && valid[1]);
      CoverThirdPass : cover (step_o.valid && pass[2] == 7'd2 && last_pass_out && !row[2].gap_pass[6]);
      CoverOdd : cover (step_o.valid && !step_o.row_b && at[2] == 9'd2);
    end
  end
endmodule : slog_rules_walker

bind slog_walker slog_rules_walker #(.Pitch(Pitch), .RingRows(RingRows), .DrainClocks(DrainClocks), .RowW(RowW),
                                     .DrainW(DrainW)) u_rules (.*);
