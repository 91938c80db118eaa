// SPDX-License-Identifier: Apache-2.0
// Counts the ones of both groups in every lane, except group A's bit 0, which is output as extra_o and added later.
//
//   count[k] + extra[k] = popcount(a_i[k]) + popcount(b_i[k])
//
// A tree of registered full adders: a node of level l adds two l-bit numbers of level l-1 (level 0: bits of group B)
// and one bit of group A as carry in. Numbers are bit-skewed, bit i one clock after bit i-1, so that every carry takes
// a clock and there is one full adder between registers. All nodes of a level share one word: level l has
// N = GroupBits / 2**l nodes and takes group A's bits 2*N-1..N; node r adds numbers r and r + N of level l-1.
//
// Stage   registers                    valid after the clock of a_i, b_i
//   l     enter_q, rest_q of level l+1 l: group A's bits that enter at level l+1, and at the levels above
//   l     sum, carry of level l        l + i: bit i
//         top_q of level l             l + l: the top bit, delayed to be one clock after the bit below it
//
// Latency    : count bit i: Levels + i clocks; extra: Levels - 1 clocks.
// Throughput : one count per lane and clock. Everything holds while move_i is low.
// Formats    : count unsigned, 0..2*GroupBits-1.
`include "slog_assert.svh"
module slog_popcount #(
    parameter  int unsigned GroupBits = 8,
    parameter  int unsigned Lanes     = 5,
    localparam int unsigned Levels    = slog_array_pkg::levels(GroupBits)
) (
    input  logic                 clk_i,
    input  logic                 move_i,
    input  logic [GroupBits-1:0] a_i[Lanes],
    input  logic [GroupBits-1:0] b_i[Lanes],
    output logic [Levels:0]      count_o[Lanes],
    output logic                 extra_o[Lanes]
);
  // Group A's bits that enter at level l (enter), and those for the levels above (rest).
  for (genvar l = 1; l <= Levels; l++) begin : g_late
    localparam int unsigned Nodes = GroupBits >> l;
    logic [Nodes-1:0] enter[Lanes], rest[Lanes];
    if (l == 1) begin : g_now
      always_comb begin
        /* verilator unroll_disable */
        for (int unsigned k = 0; k < Lanes; k++) begin
          enter[k] = a_i[k][2*Nodes-1:Nodes];
          rest[k]  = a_i[k][Nodes-1:0];
        end
      end
    end else begin : g_delay
      logic [Nodes-1:0] enter_q[Lanes], rest_q[Lanes];
      always_ff @(posedge clk_i) begin
        if (move_i) begin
          static logic [Nodes-1:0] high[Lanes];
          static logic [Nodes-1:0] low[Lanes];
          /* verilator unroll_disable */
          for (int unsigned k = 0; k < Lanes; k++) begin
            high[k] = g_late[l-1].rest[k][2*Nodes-1:Nodes];
            low[k]  = g_late[l-1].rest[k][Nodes-1:0];
          end
          enter_q <= high;
          rest_q  <= low;
        end
      end
      assign enter = enter_q;
      assign rest  = rest_q;
    end
  end

  // Bit i of the numbers of level l, all nodes in one word.
  for (genvar l = 0; l <= Levels; l++) begin : g_level
    localparam int unsigned Nodes = GroupBits >> l;
    for (genvar i = 0; i <= l; i++) begin : g_bit
      logic [Nodes-1:0] number[Lanes];
      if (l == 0) begin : g_leaf
        assign number = b_i;
      end else if (i < l) begin : g_add
        logic [Nodes-1:0] carry_in[Lanes], carry[Lanes];
        if (i == 0) begin : g_in
          assign carry_in = g_late[l].enter;
        end else begin : g_in
          assign carry_in = g_level[l].g_bit[i-1].g_add.carry;
        end
        slog_add_halves #(.Width(Nodes), .Lanes(Lanes)) u_add (
            .clk_i, .move_i, .bits_i(g_level[l-1].g_bit[i].number), .carry_i(carry_in),
            .sum_o(number), .carry_o(carry)
        );
      end else begin : g_top
        logic [Nodes-1:0] top_q[Lanes];
        always_ff @(posedge clk_i) begin
          if (move_i) top_q <= g_level[l].g_bit[i-1].g_add.carry;
        end
        assign number = top_q;
      end
    end
  end

  for (genvar i = 0; i <= Levels; i++) begin : g_count
    always_comb begin
      /* verilator unroll_disable */
      for (int unsigned k = 0; k < Lanes; k++) count_o[k][i] = g_level[Levels].g_bit[i].number[k];
    end
  end
  assign extra_o = g_late[Levels].rest;

  `SLOG_ASSERT_INIT(SlogPopcountPowerOfTwo, GroupBits == 2 ** Levels && Levels >= 1)
endmodule : slog_popcount
