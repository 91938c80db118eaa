// SPDX-License-Identifier: Apache-2.0
// slog_peak_room against the plain count of the scores granted and not yet taken.
module slog_rules_peak_room #(
    parameter int unsigned Depth      = 20,
    parameter int unsigned MaxOffsets = 12,
    parameter int unsigned HeldW      = 5
) (
    input logic             clk_i,
    input logic             rst_i,
    input logic             grant,
    input logic [9:0]       row_offsets_i,
    input logic             row_ready_o,
    input logic             taken_i,
    input logic [HeldW-1:0] held_q,
    input logic             taken_q,
    input logic [1:0]       left_q
);
  int unsigned owed_q;  // scores granted and not yet taken
  logic waits_q;        // a score left in the clock before a grant
  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      owed_q    <= 0;
      waits_q   <= 1'b0;
    end else begin
      owed_q    <= owed_q + (grant ? 32'(row_offsets_i) : 0) - 32'(taken_i);
      waits_q   <= grant && taken_q;
    end
    if (!rst_i) begin
      AssumeTakenWasGranted : assume (!(taken_i && owed_q == 0));
      RulesPeakRoomNoOverflow : assert (owed_q <= Depth);
      RulesPeakRoomGrantFits : assert (!row_ready_o || owed_q + MaxOffsets <= Depth);
      RulesPeakRoomHeld : assert (32'(held_q) == owed_q + 32'(left_q));
      RulesPeakRoomLeft : assert (left_q == 2'(taken_q) + 2'(waits_q));
      CoverFull : cover (owed_q == Depth);
      CoverTwoLeft : cover (left_q == 2'd2);
      CoverGrantAtLimit : cover (grant && owed_q + MaxOffsets == Depth);
      CoverRefilled : cover (grant && owed_q != 0);
    end
  end
endmodule : slog_rules_peak_room

bind slog_peak_room slog_rules_peak_room #(.Depth(Depth), .MaxOffsets(MaxOffsets), .HeldW(HeldW)) u_rules (.*);
