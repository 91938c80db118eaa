// SPDX-License-Identifier: Apache-2.0
// Reserves room for whole rows of scores, because the array cannot be stopped within a row.
//
// held = scores granted and not yet taken; a row may be granted while held + MaxOffsets <= Depth.
//
// Latency    : row_ready_o is low in the clock after a grant and reflects the grant from the second clock on.
// Throughput : a grant in every other clock.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_peak_room #(
    parameter int unsigned Depth      = 1024,
    parameter int unsigned MaxOffsets = 640
) (
    input  logic       clk_i,
    input  logic       rst_i,
    input  logic       row_valid_i,
    output logic       row_ready_o,
    input  logic [9:0] row_offsets_i,
    input  logic       taken_i          // a score leaves the queue
);
  `SLOG_ASSERT_INIT(SlogPeakRoomDepth, Depth >= MaxOffsets)
  localparam int unsigned HeldW = $clog2(Depth + 1);

  logic [HeldW-1:0] held_q;
  logic ready_q, taken_q, grant;
  logic [1:0] left_q;  // scores that left and are still to be subtracted; two if one had to wait for a grant

  assign row_ready_o = ready_q;
  assign grant       = row_valid_i && ready_q;

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      held_q  <= '0;
      ready_q <= 1'b0;
      taken_q <= 1'b0;
      left_q  <= '0;
    end else begin
      taken_q <= taken_i;
      // In the clock of a grant no score is subtracted.
      left_q  <= 2'(taken_i) + 2'(grant && taken_q);
      held_q  <= grant ? held_q + HeldW'(row_offsets_i) : held_q - HeldW'(left_q);
      ready_q <= !grant && held_q <= HeldW'(Depth - MaxOffsets);
    end
  end

  `SLOG_ASSERT(SlogPeakRoomHeld, held_q <= HeldW'(Depth))
  `SLOG_ASSERT(SlogPeakRoomOffsets, !grant || (row_offsets_i != '0 && 32'(row_offsets_i) <= MaxOffsets))
  `SLOG_ASSERT_NEXT(SlogPeakRoomApart, grant, !row_ready_o)
endmodule : slog_peak_room
