// Reserves room for whole rows of scores, because the array cannot be stopped within a row.
//
// held = scores granted and not yet taken out; a row is granted while held + MaxOffsets <= Depth.
//
// Latency    : a grant shows in row_ready_o two clocks later; row_ready_o is low in between.
// Throughput : a grant in every other clock.
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
    input  logic       taken_i          // a score left
);
  `SLOG_ASSERT_INIT(SlogPeakRoomDepth, Depth >= MaxOffsets)
  localparam int unsigned HeldW = $clog2(Depth + 1);

  logic [HeldW-1:0] held_q;
  logic ready_q, taken_q, grant;
  logic [1:0] left_q;  // scores that left and are not counted: taken_q, and one that left while a grant was counted

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
      // A grant has the clock to itself.
      left_q  <= 2'(taken_i) + 2'(grant && taken_q);
      held_q  <= grant ? held_q + HeldW'(row_offsets_i) : held_q - HeldW'(left_q);
      ready_q <= !grant && held_q <= HeldW'(Depth - MaxOffsets);
    end
  end

  `SLOG_ASSERT(SlogPeakRoomHeld, held_q <= HeldW'(Depth))
  `SLOG_ASSERT(SlogPeakRoomOffsets, !grant || (row_offsets_i != '0 && 32'(row_offsets_i) <= MaxOffsets))
endmodule : slog_peak_room
