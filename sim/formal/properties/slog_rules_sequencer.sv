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
    input logic            prepare_q,
    input logic            context_q,
    input logic [2:0]      prep_q,
    input logic            row_valid_q,
    input logic            granted_q,
    input logic            took_q,
    input logic            ended_q,
    input logic            same_width_q,
    input logic            drained,
    input logic            token_valid_q
);
  logic [RowW-1:0] written_q, ahead, now_ahead;
  logic [1:0] done_q;
  logic started_q;
  logic begun_q;            // a row of the present job has been given its operands
  logic [RowW-1:0] rows_given_q;  // how many, modulo 2**RowW
  logic [RowW-1:0] need;    // ring rows that the next row of offsets needs
  assign need = t_q.row[RowW-1:0] + RowW'(t_q.job.height) + rows_given_q;
  assign now_ahead = rows_written_i - need_q;
  assign ahead = written_q - need;  // by the rows of the clock before
  always_ff @(posedge clk_i) begin
    written_q <= rows_written_i;
    done_q    <= tpl_done_i;
    started_q <= !rst_i;
    if (rst_i || !rows_q) begun_q <= 1'b0;
    else if (token) begun_q <= 1'b1;
    if (rst_i || !rows_q) rows_given_q <= '0;
    else if (token) rows_given_q <= rows_given_q + 1'b1;
    if (!rst_i) begin
      AssumeWritten : assume (!started_q || rows_written_i == written_q || rows_written_i == written_q + 1'b1);
      RulesSequencerOperands : assert (!token || !started_q || (!ahead[RowW-1] && done_q[t_q.bank]));
      // slog_fetch loads a job's template before its first search row, writes the rows of earlier jobs before either
      // (RulesFetchTemplateFirst), and keeps a template until the job's last row has ended.
      AssumeTemplateFirst : assume (!rows_q || begun_q || tpl_done_i[t_q.bank] || rows_written_i == t_q.row[RowW-1:0]);
      AssumeTemplateStays : assume (!rows_q || !begun_q || tpl_done_i[t_q.bank]);
      AssumeTemplateKept : assume (!rows_q || !started_q || !done_q[t_q.bank] || tpl_done_i[t_q.bank]);
      AssumeHeight : assume (!rows_q || (t_q.job.height != '0 && 32'(t_q.job.height) <= 2 ** (RowW - 1)));
      // Two conditions of the RTL never decide: without them it does the same.
      RulesSequencerNoToken : assert (!(masking_q && !same_width_q && drained && token_valid_q));
      RulesSequencerTemplate : assert (!rows_q || now_ahead[RowW-1] || tpl_done_i[t_q.bank]);
      // For the induction: what belongs to each state.
      InductivePrepare : assert (prepare_q ? $onehot0(prep_q) : prep_q == '0);
      InductiveRows : assert (rows_q || !(row_valid_q || granted_q || took_q || ended_q));
      InductiveTurn : assert ($onehot0({row_valid_q, granted_q, took_q}) && (!ended_q || took_q)
                              && (!took_q || (token_valid_q && begun_q)) && (!granted_q || !token_valid_q));
      InductiveNeed : assert (!(context_q || masking_q || rows_q || (prepare_q && prep_q[2:1] != '0))
                              || RowW'(need_q + RowW'(took_q)) == need);
      InductiveGiven : assert (begun_q || rows_given_q == '0);
      CoverRow : cover (token);
      CoverWaits : cover (rows_q && tpl_done_i[t_q.bank] && now_ahead[RowW-1]);
      CoverMask : cover (masking_q && !same_width_q && drained);
    end
  end
endmodule : slog_rules_sequencer

bind slog_sequencer slog_rules_sequencer #(.RowW(RowW)) u_rules (.*, .ended_q(done_q));
