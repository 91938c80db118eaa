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
    input ticket_t         t_q,
    input logic            masking_q,
    input logic            rows_q,
    input logic            same_width_q,
    input logic            drained,
    input logic            token_valid_q
);
  logic [RowW-1:0] written_q, ahead, now_ahead;
  logic [1:0] done_q;
  logic started_q;
  assign now_ahead = rows_written_i - need_q;
  assign ahead = written_q - need_q;  // by the rows of the clock before
  always_ff @(posedge clk_i) begin
    written_q <= rows_written_i;
    done_q    <= tpl_done_i;
    started_q <= !rst_i;
    if (!rst_i) begin
      AssumeWritten : assume (!started_q || rows_written_i == written_q || rows_written_i == written_q + 1'b1);
      AssumeDone : assume (!started_q || (done_q & ~tpl_done_i) == '0 || bank_free_o);
      RulesSequencerOperands : assert (!token || !started_q || (!ahead[RowW-1] && done_q[t_q.bank]));
      // slog_fetch loads a job's template before its first search row, and writes the rows of earlier jobs before either
      // (RulesFetchTemplateFirst).
      AssumeTemplateFirst : assume (!rows_q || tpl_done_i[t_q.bank] || rows_written_i == t_q.row[RowW-1:0]);
      AssumeHeight : assume (!rows_q || (t_q.job.height != '0 && 32'(t_q.job.height) <= 2 ** (RowW - 1)));
      // Two conditions of the RTL never decide: without them it does the same.
      RulesSequencerNoToken : assert (!(masking_q && !same_width_q && drained && token_valid_q));
      RulesSequencerTemplate : assert (!rows_q || now_ahead[RowW-1] || tpl_done_i[t_q.bank]);
      CoverRow : cover (token);
      CoverWaits : cover (rows_q && tpl_done_i[t_q.bank] && now_ahead[RowW-1]);
      CoverMask : cover (masking_q && !same_width_q && drained);
    end
  end
endmodule : slog_rules_sequencer

bind slog_sequencer slog_rules_sequencer #(.RowW(RowW)) u_rules (.*);
