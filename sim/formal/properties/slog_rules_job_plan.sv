// SPDX-License-Identifier: Apache-2.0
// slog_job_plan against its equations, for every job that slog_job_check accepts.
//
// The job starts in the first clock after reset. This loses nothing, because the registers that a reset leaves alone hold
// anything then, and those that it clears are cleared whenever no job is in work.
module slog_rules_job_plan
  import slog_pkg::*, slog_fetch_pkg::*;
#(
    parameter int unsigned Width       = 64,
    parameter int unsigned MaxHeight   = 480,
    parameter int unsigned WordsPerRow = 10,
    parameter int unsigned WordsBits   = 4
) (
    input logic  clk_i,
    input logic  rst_i,
    input logic  start_i,
    input job_t  job_i,
    input load_t tpl_o,
    input load_t search_o
);
  localparam int unsigned Latency = WordsBits + 5;
  job_t job_q;
  logic [4:0] clock_q;  // clocks since start_i; Latency: the plan is valid; 31: none is wanted
  always_ff @(posedge clk_i) begin
    if (rst_i) clock_q <= 5'd31;
    else if (start_i) clock_q <= 5'd1;
    else if (32'(clock_q) < Latency) clock_q <= clock_q + 1'b1;
    if (start_i) job_q <= job_i;
  end

  function automatic load_t wanted(logic [2:0] slot, logic [9:0] x, logic [9:0] y, int unsigned bits, int unsigned rows);
    int unsigned address = (32'(slot) * MaxHeight + 32'(y)) * WordsPerRow + 32'(x) / Width;
    int unsigned words_in = (32'(x) + bits - 1) / Width - 32'(x) / Width;
    int unsigned words_out = (bits - 1) / Width;
    int unsigned shift = 32'(x) % Width;
    int unsigned last = rows - 1;
    return '{addr: address[15:0], shift: shift[5:0], words_in: words_in[3:0], words_out: words_out[3:0], rows: last[9:0]};
  endfunction
  function automatic logic accepted(job_t job);
    return job.width != '0 && job.height != '0 && job.offsets_x != '0 && job.offsets_y != '0
           && 32'(job.tpl_x) + 32'(job.width) <= Width * WordsPerRow && 32'(job.tpl_y) + 32'(job.height) <= MaxHeight
           && 32'(job.search_x) + 32'(job.width) + 32'(job.offsets_x) - 1 <= Width * WordsPerRow
           && 32'(job.search_y) + 32'(job.height) + 32'(job.offsets_y) - 1 <= MaxHeight;
  endfunction
  logic begun_q = 1'b0;
  always_ff @(posedge clk_i) begin
    begun_q <= begun_q || !rst_i;
    AssumeNoReset : assume (!begun_q || !rst_i);
    AssumeAccepted : assume (!start_i || accepted(job_i));
    if (!rst_i) begin
      AssumeStable : assume (start_i || clock_q == 5'd31 || job_i == job_q);
      AssumeOnce : assume (start_i == (clock_q == 5'd31));
      if (32'(clock_q) == Latency) begin
        RulesJobPlanTemplate : assert (tpl_o == wanted(job_q.tpl_slot, job_q.tpl_x, job_q.tpl_y, 32'(job_q.width),
                                                       32'(job_q.height)));
        RulesJobPlanSearch : assert (search_o == wanted(job_q.search_slot, job_q.search_x, job_q.search_y,
            32'(job_q.width) + 32'(job_q.offsets_x) - 1, 32'(job_q.height) + 32'(job_q.offsets_y) - 1));
      end
      CoverWide : cover (32'(clock_q) == Latency && tpl_o.words_in > tpl_o.words_out && search_o.shift != '0);
    end
  end
endmodule : slog_rules_job_plan

bind slog_job_plan slog_rules_job_plan #(.Width(Width), .MaxHeight(MaxHeight), .WordsPerRow(WordsPerRow),
                                         .WordsBits(WordsBits)) u_rules (.*);
