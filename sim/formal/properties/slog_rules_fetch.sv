// SPDX-License-Identifier: Apache-2.0
// slog_fetch reads exactly the words of its plans, in order and only while the slots are marked busy; writes no ring row
// that is not free; and loads a job's template before its first search row.
//
// slog_job_check and slog_job_plan, proved alone, may give any result that their own proofs allow.
module slog_rules_fetch
  import slog_pkg::*, slog_fetch_pkg::*;
#(
    parameter int unsigned AddrW       = 5,
    parameter int unsigned RowW        = 3,
    parameter int unsigned Slots       = 2,
    parameter int unsigned SlotWords   = 16,
    parameter int unsigned WordsPerRow = 2
) (
    input logic              clk_i,
    input logic              rst_i,
    input logic              job_valid_i,
    input logic              job_ready_o,
    input logic              busy_o,
    input job_t              job_q,
    input logic              start_q,
    input logic              check_q,
    input logic              checked,
    input logic              accept_q,
    input status_e           status,
    input logic [ScoreW-1:0] area,
    input load_t             tpl_plan,
    input load_t             search_plan,
    input logic              rd_valid_o,
    input logic [AddrW-1:0]  rd_addr_o,
    input logic [7:0]        slot_busy_o,
    input logic              ticket_valid_o,
    input ticket_t           ticket_o,
    input logic [RowW-1:0]   rows_freed_i,
    input logic [RowW-1:0]   rows_written_o,
    input logic              bank_free_i,
    input logic [1:0]        banks_used_q,
    input logic              bank_q,
    input logic [1:0]        tpl_done_o,
    input logic              wr_valid_o,
    input logic              wr_tpl_o,
    input logic [7:0]        wr_row_o
);
  localparam int unsigned RingRows = 2 ** (RowW - 1);
  typedef struct packed {
    status_e           status;
    logic [ScoreW-1:0] area;
    load_t             tpl;
    load_t             search;
  } result_t;
  result_t result, result_q;
  load_t tpl_q, search_q, now;
  logic [1:0] phase_q;       // 0: nothing is to be read, 1: the template's words, 2: the search's
  logic [9:0] row_q;
  logic [3:0] word_q;
  logic may_change_q, was_reset_q;
  logic [3:0] check_age_q, age_q;  // clocks since the check began; since the ticket
  logic [RowW-1:0] freed_q, total_q, begin_q;  // search rows of all jobs accepted; of those before this one
  logic [3:0] taken_q;  // clocks for which a job that was taken keeps the next one waiting, at least: slog_rules_board
  assign result = '{status: status, area: area, tpl: tpl_plan, search: search_plan};
  assign now    = (phase_q == 2'd1) ? tpl_q : search_q;

  // A plan that lies in its slot, which the board has.
  function automatic logic inside_slot(load_t plan, logic [2:0] slot);
    int unsigned from = 32'(plan.addr) % SlotWords;
    return 32'(slot) < Slots && 32'(plan.addr) / SlotWords == 32'(slot) && from % WordsPerRow + 32'(plan.words_in) < WordsPerRow
           && from / WordsPerRow + 32'(plan.rows) < SlotWords / WordsPerRow && plan.words_out <= plan.words_in
           && plan.words_in - plan.words_out <= 4'd1;
  endfunction

  always_ff @(posedge clk_i) begin
    result_q     <= result;
    may_change_q <= start_q || (check_q && !checked);
    was_reset_q  <= rst_i;
    freed_q      <= rows_freed_i;
    if (start_q) check_age_q <= '0;
    else if (check_age_q != '1) check_age_q <= check_age_q + 1'b1;
    if (rst_i) taken_q <= '0;
    else if (job_valid_i && job_ready_o) taken_q <= 4'd8;
    else if (taken_q != '0) taken_q <= taken_q - 1'b1;
    if (rst_i) begin
      phase_q <= '0;
      total_q <= '0;
      begin_q <= '0;
      age_q   <= '1;
    end else begin
      if (accept_q) age_q <= '0;
      else if (age_q != '1) age_q <= age_q + 1'b1;
      if (accept_q) begin
        tpl_q    <= tpl_plan;
        search_q <= search_plan;
        begin_q  <= total_q;
        total_q  <= total_q + RowW'(search_plan.rows) + 1'b1;
        phase_q  <= 2'd1;
        row_q    <= '0;
        word_q   <= '0;
      end else if (rd_valid_o) begin
        word_q <= word_q + 1'b1;
        if (word_q == now.words_in) begin
          word_q <= '0;
          row_q  <= row_q + 1'b1;
          if (row_q == now.rows) begin
            row_q   <= '0;
            phase_q <= (phase_q == 2'd1) ? 2'd2 : 2'd0;
          end
        end
      end
    end
    if (!rst_i) begin
      AssumeStays : assume (may_change_q || result == result_q);
      AssumeLatency : assume (!(check_q && checked) || check_age_q >= 4'd7);
      AssumeInSlot : assume (!(check_q && checked && status == StatusOk)
                             || (inside_slot(tpl_plan, job_q.tpl_slot) && inside_slot(search_plan, job_q.search_slot)));
      AssumeFreed : assume (was_reset_q ? rows_freed_i == '0
                            : RowW'(rows_freed_i - freed_q) <= RowW'(rows_written_o - freed_q));
      AssumeBank : assume (!bank_free_i || banks_used_q != '0);
      RulesFetchTakes : assert (!job_ready_o || taken_q == '0);
      RulesFetchAtWork : assert (job_ready_o || busy_o);
      RulesFetchOne : assert (!accept_q || phase_q == '0);
      RulesFetchRead : assert (!rd_valid_o || (phase_q != '0
                               && 32'(rd_addr_o) == 32'(now.addr) + 32'(row_q) * WordsPerRow + 32'(word_q)));
      RulesFetchBusy : assert (!rd_valid_o || (slot_busy_o[job_q.tpl_slot] && slot_busy_o[job_q.search_slot]));
      RulesFetchTicket : assert (!ticket_valid_o || ticket_o.status != StatusOk || age_q > 4'd3
                                 || ticket_o.row[RowW-1:0] == begin_q);
      RulesFetchRingFree : assert (!(wr_valid_o && !wr_tpl_o)
                                   || (32'(RowW'(rows_written_o - rows_freed_i)) < RingRows
                                       && 32'(wr_row_o) == 32'(rows_written_o) % RingRows));
      RulesFetchTemplateFirst : assert (age_q < 4'd7 || phase_q == '0 || tpl_done_o[bank_q] || rows_written_o == begin_q);
      CoverSearch : cover (wr_valid_o && !wr_tpl_o && rows_written_o == RowW'(1));
      CoverFull : cover (phase_q == 2'd2 && RowW'(total_q - rows_freed_i) > RowW'(RingRows) && !rd_valid_o && age_q == '1);
      CoverTwoWords : cover (phase_q == 2'd2 && rd_valid_o && word_q == 4'd1);
    end
  end
endmodule : slog_rules_fetch

bind slog_fetch slog_rules_fetch #(.AddrW(AddrW), .RowW(RowW), .Slots(Slots), .SlotWords(MaxHeight * WordsPerRow),
                                   .WordsPerRow(WordsPerRow)) u_rules (.*);
