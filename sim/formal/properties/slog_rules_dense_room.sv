// SPDX-License-Identifier: Apache-2.0
// slog_dense_room against the plain count of the words reserved and not yet taken.
module slog_rules_dense_room #(
    parameter int unsigned Depth = 20,
    parameter int unsigned FreeW = 5
) (
    input logic             clk_i,
    input logic             rst_i,
    input logic [9:0]       words_i,
    input logic             reserve_i,
    input logic             taken_i,
    input logic             room_o,
    input logic             empty_o,
    input logic             taken_q,
    input logic [FreeW-1:0] free_q
);
  int unsigned owed_q;    // words reserved and not yet taken, and that of taken_q
  int unsigned before_q;  // the same one clock ago
  logic [9:0] words_q;
  logic reserve_q, ready_q = 1'b0;
  always_ff @(posedge clk_i) begin
    words_q   <= words_i;
    reserve_q <= reserve_i;
    before_q  <= owed_q;
    ready_q   <= !rst_i;
    if (rst_i) owed_q <= 0;
    else owed_q <= owed_q + (reserve_i ? 32'(words_i) : 0) - 32'(taken_q);
    if (!rst_i) begin
      AssumeWords : assume (!reserve_i || 32'(words_i) <= Depth);
      AssumeReserve : assume (!reserve_i || (ready_q && !reserve_q && (empty_o || (room_o && words_i == words_q))));
      AssumeTakenWasReserved : assume (!(taken_i && owed_q == 32'(taken_q)));
      RulesDenseRoomNoOverflow : assert (owed_q <= Depth);
      RulesDenseRoomFree : assert (32'(free_q) + owed_q == Depth);
      RulesDenseRoomEmpty : assert (!ready_q || !empty_o || before_q == 0);
      RulesDenseRoomRoom : assert (!ready_q || 32'(words_q) > Depth || room_o == (before_q + 32'(words_q) <= Depth));
      CoverFull : cover (owed_q == Depth);
      CoverReserveAtLimit : cover (reserve_i && owed_q != 0 && owed_q + 32'(words_i) == Depth);
      CoverEmptyAgain : cover (empty_o && before_q == 0 && reserve_i);
    end
  end
endmodule : slog_rules_dense_room

bind slog_dense_room slog_rules_dense_room #(.Depth(Depth), .FreeW(FreeW)) u_rules (.*);
