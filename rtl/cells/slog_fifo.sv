// SPDX-License-Identifier: Apache-2.0
// First-in first-out queue with registered storage and flags and a combinational front.
//
// Latency    : a word pushed in clock t is offered in clock t+1.
// Throughput : one push and one pop per clock, also when full (a pop frees its place in the next clock).
// With Kept  : the user asserts in_valid_i only with in_ready_o and out_ready_i only with out_valid_o. This is checked by an
//              assertion; the logic that would guard against it is left out.
// Formats    : opaque words of Width bits; level_o counts the words held, 0..Depth.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_fifo #(
    parameter  int unsigned Width  = 8,
    parameter  int unsigned Depth  = 4,
    parameter  bit          Kept   = 1'b0,
    localparam int unsigned LevelW = $clog2(Depth + 1)
) (
    input  logic              clk_i,
    input  logic              rst_i,
    input  logic              in_valid_i,
    output logic              in_ready_o,
    input  logic [Width-1:0]  in_data_i,
    output logic              out_valid_o,
    input  logic              out_ready_i,
    output logic [Width-1:0]  out_data_o,
    output logic [LevelW-1:0] level_o
);
  `SLOG_ASSERT_INIT(SlogFifoDepth, Depth >= 1)
  localparam int unsigned AddrW = (Depth > 1) ? $clog2(Depth) : 1;
  localparam logic [AddrW-1:0] Last = AddrW'(Depth - 1);

  logic [Width-1:0] mem_q[Depth];
  logic [AddrW-1:0] head_q, tail_q;
  logic [Depth:0] held_q;  // number of words held, one-hot: each flag is one of its bits, without a comparator
  logic push, pop, up, down;

  assign in_ready_o  = !held_q[Depth];
  assign out_valid_o = !held_q[0];
  assign out_data_o  = mem_q[head_q];
  assign push        = in_valid_i && (Kept || in_ready_o);
  assign pop         = out_ready_i && (Kept || out_valid_o);
  assign up          = push && !pop;
  assign down        = pop && !push;

  function automatic logic [AddrW-1:0] after(logic [AddrW-1:0] place);
    return (place == Last) ? '0 : place + 1'b1;
  endfunction

  always_comb begin
    level_o = '0;
    for (int unsigned n = 1; n <= Depth; n++) if (held_q[n]) level_o |= LevelW'(n);
  end

  always_ff @(posedge clk_i) begin
    if (push) mem_q[tail_q] <= in_data_i;
  end

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      head_q <= '0;
      tail_q <= '0;
      held_q <= (Depth + 1)'(1);
    end else begin
      if (push) tail_q <= after(tail_q);
      if (pop) head_q <= after(head_q);
      // A multiplexer, not a clock enable: the enable would cost a level of logic.
      held_q <= ({Depth + 1{up}} & held_q << 1) | ({Depth + 1{down}} & held_q >> 1)
              | ({Depth + 1{!(up || down)}} & held_q);
    end
  end

  `SLOG_ASSERT(SlogFifoLevelInRange, $onehot(held_q))
  `SLOG_ASSERT(SlogFifoPlaces, (32'(head_q) + 32'(level_o)) % Depth == 32'(tail_q))
  `SLOG_ASSERT(SlogFifoKept, !Kept || (!(in_valid_i && !in_ready_o) && !(out_ready_i && !out_valid_o)))
  `SLOG_ASSERT_STABLE(SlogFifoOutStable, out_valid_o, out_ready_i, out_data_o)
endmodule : slog_fifo
