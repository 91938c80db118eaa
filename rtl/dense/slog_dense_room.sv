// SPDX-License-Identifier: Apache-2.0
// Room for the words of the map: a row reserves places for all its words before it starts, so that none is ever lost.
//
//   free = Depth - words reserved + words taken by the sink
//
// Stage  registers
//   0    taken_q: the sink is far away
//   1    free_q
//   2    room_o: free_q >= words_i;  empty_o: free_q == Depth, every word that was reserved has been taken
// Latency    : words_i to room_o 1 clock; reserve_i to room_o and empty_o 2 clocks, taken_i 3.
// Throughput : one word taken per clock.
// Rules      : reserve_i only with empty_o, or where room_o is of the present words_i: 1 clock or more after words_i has
//              changed. 2 clocks or more lie from one reserve_i to the next. words_i is Depth at most then. No word is
//              taken that was not reserved.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_dense_room #(
    parameter  int unsigned Depth = 2048,
    localparam int unsigned FreeW = $clog2(Depth + 1)
) (
    input  logic       clk_i,
    input  logic       rst_i,
    input  logic [9:0] words_i,
    input  logic       reserve_i,
    input  logic       taken_i,
    output logic       room_o,
    output logic       empty_o
);
  logic [FreeW-1:0] free_q, reserved;
  logic room_q, empty_q, taken_q;

  assign reserved = reserve_i ? FreeW'(words_i) : '0;
  always_ff @(posedge clk_i) begin
    room_q  <= free_q >= FreeW'(words_i);
    empty_q <= free_q == FreeW'(Depth) && !reserve_i;
    if (rst_i) begin
      taken_q <= 1'b0;
      free_q  <= FreeW'(Depth);
    end else begin
      taken_q <= taken_i;
      free_q  <= free_q - reserved + FreeW'(taken_q);
    end
  end
  assign room_o  = room_q;
  assign empty_o = empty_q;

  `SLOG_ASSERT(SlogDenseRoomReserve, !reserve_i || FreeW'(words_i) <= free_q)
  `SLOG_ASSERT(SlogDenseRoomTaken, !taken_i || 32'(free_q) + 32'(taken_q) < Depth)
  `SLOG_ASSERT(SlogDenseRoomFree, free_q <= FreeW'(Depth))
  `SLOG_ASSERT(SlogDenseRoomWords, !reserve_i || 32'(words_i) <= Depth)
endmodule : slog_dense_room
