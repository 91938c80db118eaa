// SPDX-License-Identifier: Apache-2.0
// slog_job_check against the contract: the first of the reasons that applies, in plain arithmetic.
module slog_rules_job_check
  import slog_pkg::*;
#(
    parameter int unsigned MinWindow = 8,
    parameter int unsigned MaxWindow = 128,
    parameter int unsigned Slots     = 6
) (
    input logic              clk_i,
    input logic              rst_i,
    input logic              start_i,
    input job_t              job_i,
    input logic [9:0]        image_width_i,
    input logic [9:0]        image_height_i,
    input logic [7:0]        slot_valid_i,
    input logic              done_o,
    input status_e           status_o,
    input logic              busy_q,
    input logic [3:0]        step_q
);
  job_t job_q;
  logic [9:0] image_width_q, image_height_q;
  logic [7:0] slots_q;
  logic [3:0] clock_q;  // clocks since start_i; 0: idle
  status_e wanted;
  always_comb begin
    wanted = StatusOk;
    if (32'(job_q.width) < MinWindow || 32'(job_q.width) > MaxWindow || 32'(job_q.height) < MinWindow
        || 32'(job_q.height) > MaxWindow) wanted = StatusBadWindow;
    else if (job_q.offsets_x == '0 || job_q.offsets_y == '0) wanted = StatusNoOffsets;
    else if (32'(job_q.tpl_slot) >= Slots || 32'(job_q.search_slot) >= Slots || !slots_q[job_q.tpl_slot]
             || !slots_q[job_q.search_slot]) wanted = StatusBadSlot;
    else if (32'(job_q.tpl_x) + 32'(job_q.width) > 32'(image_width_q)
             || 32'(job_q.tpl_y) + 32'(job_q.height) > 32'(image_height_q)
             || 32'(job_q.search_x) + 32'(job_q.width) + 32'(job_q.offsets_x) - 1 > 32'(image_width_q)
             || 32'(job_q.search_y) + 32'(job_q.height) + 32'(job_q.offsets_y) - 1 > 32'(image_height_q))
      wanted = StatusOutside;
  end
  always_ff @(posedge clk_i) begin
    if (rst_i) clock_q <= '0;
    else if (start_i) clock_q <= 4'd1;
    else if (clock_q == 4'd9) clock_q <= '0;
    else if (clock_q != '0) clock_q <= clock_q + 1'b1;
    if (start_i) begin
      job_q          <= job_i;
      image_width_q  <= image_width_i;
      image_height_q <= image_height_i;
      slots_q        <= slot_valid_i;
    end
    if (!rst_i) begin
      RulesJobCheckLatency : assert (done_o == (clock_q == 4'd9));
      RulesJobCheckBusy : assert (busy_q == (clock_q inside {[4'd1 : 4'd8]}) && (!busy_q || step_q == clock_q));
      RulesJobCheckStatus : assert (!done_o || status_o == wanted);
      CoverOk : cover (done_o && status_o == StatusOk);
      CoverBadWindow : cover (done_o && status_o == StatusBadWindow);
      CoverNoOffsets : cover (done_o && status_o == StatusNoOffsets);
      CoverBadSlot : cover (done_o && status_o == StatusBadSlot);
      CoverOutside : cover (done_o && status_o == StatusOutside);
      CoverWrapRow : cover (done_o && status_o == StatusOutside && 12'(job_q.search_y) + 12'(job_q.height)
                            + 12'(job_q.offsets_y) > 12'd2048);
      CoverAgain : cover (done_o && start_i);
    end
  end
endmodule : slog_rules_job_check

bind slog_job_check slog_rules_job_check #(.MinWindow(MinWindow), .MaxWindow(MaxWindow), .Slots(Slots)) u_rules (.*);
