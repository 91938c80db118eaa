// SPDX-License-Identifier: Apache-2.0
// slog_board's busy status: the grid's !command_ready alone makes it 1 in the clock after a submit only.
//
// The correlator may do anything that its header allows: busy_o is high two clocks after a job is offered and two clocks
// after job_ready_o is low, and job_ready_o stays low for eight clocks at least after a job is taken (slog_fetch: a refused
// job takes the fewest).
module slog_rules_board #(
    parameter int unsigned LevelW = 4
) (
    input logic              clk_i,
    input logic              rst,
    input logic              command_valid,
    input logic              command_ready,
    input logic              job_valid,
    input logic              job_ready,
    input logic [LevelW-1:0] job_level,
    input logic              work
);
  logic [1:0] busy_q;      // [k]: a job was offered, or in the correlator, k + 1 clocks ago
  logic [3:0] left_q;      // clocks for which the job taken last still keeps job_ready low
  logic command_q;         // a command was taken in the clock before
  always_ff @(posedge clk_i) begin
    busy_q    <= rst ? '0 : {busy_q[0], job_valid || !job_ready};
    command_q <= !rst && command_valid && command_ready;
    if (rst) left_q <= '0;
    else if (job_valid && job_ready) left_q <= 4'd8;
    else if (left_q != '0) left_q <= left_q - 1'b1;
    if (!rst) begin
      AssumeWork : assume (work || !busy_q[1]);
      AssumeTaken : assume (left_q == '0 || !job_ready);
      AssumeLeft : assume (left_q <= 4'd8);
      RulesBoardBusy : assert (work || job_level != '0 || command_ready || command_q);
      CoverSubmit : cover (!work && job_level == '0 && !command_ready);
      CoverBetween : cover (work && job_level == '0 && command_ready && busy_q == '1);
    end
  end
endmodule : slog_rules_board

bind slog_board slog_rules_board #(.LevelW(JobLevelW)) u_rules (.*);
