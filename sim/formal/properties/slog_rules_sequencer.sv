// SPDX-License-Identifier: Apache-2.0
// slog_sequencer starts no row of offsets without its operands: the ring rows and the template are loaded.
module slog_rules_sequencer
  import slog_fetch_pkg::*;
#(
    parameter int unsigned RowW = 6
) (
    input logic            clk_i,
    input logic            rst_i,
    input logic            token,
    input logic            bank_free_o,
    input logic [1:0]      tpl_done_i,
    input logic [RowW-1:0] rows_written_i,
    input logic [RowW-1:0] need_q,
    input ticket_t         t_q
);
  logic [RowW-1:0] written_q, ahead;
  logic [1:0] done_q;
  logic started_q;
  assign ahead = written_q - need_q;  // by the rows of the clock before
  always_ff @(posedge clk_i) begin
    written_q <= rows_written_i;
    done_q    <= tpl_done_i;
    started_q <= !rst_i;
    if (!rst_i) begin
      AssumeWritten : assume (!started_q || rows_written_i == written_q || rows_written_i == written_q + 1'b1);
      AssumeDone : assume (!started_q || (done_q & ~tpl_done_i) == '0 || bank_free_o);
      RulesSequencerOperands : assert (!token || !started_q || (!ahead[RowW-1] && done_q[t_q.bank]));
      CoverRow : cover (token);
    end
  end
endmodule : slog_rules_sequencer

bind slog_sequencer slog_rules_sequencer #(.RowW(RowW)) u_rules (.*);
