// SPDX-License-Identifier: Apache-2.0
// Adder tree of slog_fir_kernel, or of one half of its bits.
//
// {carry_o[n], sum} = a + b + carry_i[n] in node n, level by level; sum_o is that of the last node. Without CarryIn carry_i
// does not count.
//
// Stages     : clog2(Terms) levels of adders, one register more before the last two, because the terms lie far apart
// Latency    : clog2(Terms) + 1 clocks from term_i to sum_o. A node of level l adds, with its carry_i, l clocks after the terms
//              came, one of the last two levels l + 1; its carry_o comes a clock later.
// Throughput : one sum per clock.
// Formats    : terms in machine words, which simulate fast, of which the lower SumW bits are used; sums modulo 2**SumW. A
//              node is a pair of terms, numbered level by level; an odd term goes on to the next level alone. Terms are 5
//              or more, SumW is at most 32.
`include "slog_assert.svh"
module slog_fir_tree #(
    parameter  int unsigned Terms   = 10,
    parameter  int unsigned SumW    = 18,
    parameter  bit          CarryIn = 1'b1,
    localparam int unsigned Levels  = $clog2(Terms)
) (
    input  logic                   clk_i,
    /* verilator lint_off UNUSEDSIGNAL */
    input  logic [Terms-1:0][31:0] term_i,
    input  logic [Terms-2:0]       carry_i,
    /* verilator lint_on UNUSEDSIGNAL */
    output logic [Terms-2:0]       carry_o,
    output logic [SumW-1:0]        sum_o
);
  // Terms left after `level` levels of pairwise addition. Every pair takes one away.
  function automatic int unsigned terms(int unsigned level);
    return (Terms + (1 << level) - 1) >> level;
  endfunction

  for (genvar l = 0; l < Levels; l++) begin : g_level
    for (genvar n = 0; n < terms(l + 1); n++) begin : g_node
      localparam int unsigned Left  = 2 * n;
      localparam int unsigned Right = 2 * n + 1;
      logic [SumW-1:0] a, sum_q, sum;
      if (l == 0) begin : g_leaf
        assign a = term_i[Left][SumW-1:0];
      end else begin : g_inner
        assign a = g_level[l-1].g_node[Left].sum;
      end
      if (Right < terms(l)) begin : g_pair
        localparam int unsigned Node = Terms - terms(l) + n;  // as many pairs come before the level
        logic [SumW-1:0] b;
        logic [SumW:0] total;
        logic carry_q;
        if (l == 0) begin : g_leaf
          assign b = term_i[Right][SumW-1:0];
        end else begin : g_inner
          assign b = g_level[l-1].g_node[Right].sum;
        end
        if (CarryIn) begin : g_carry
          // The carry that comes in has a bit of its own, so that there is one chain of carries.
          /* verilator lint_off UNUSEDSIGNAL */
          logic [SumW+1:0] sums;
          /* verilator lint_on UNUSEDSIGNAL */
          assign sums  = {1'b0, a, 1'b1} + {1'b0, b, carry_i[Node]};
          assign total = sums[SumW+1:1];
        end else begin : g_none
          assign total = {1'b0, a} + {1'b0, b};
        end
        always_ff @(posedge clk_i) begin
          sum_q   <= total[SumW-1:0];
          carry_q <= total[SumW];
        end
        assign carry_o[Node] = carry_q;
      end else begin : g_single
        always_ff @(posedge clk_i) sum_q <= a;
      end
      if (l + 3 == Levels) begin : g_far
        logic [SumW-1:0] far_q;
        always_ff @(posedge clk_i) far_q <= sum_q;
        assign sum = far_q;
      end else begin : g_near
        assign sum = sum_q;
      end
      if (l + 1 == Levels) begin : g_last
        assign sum_o = sum;
      end
    end
  end

  `SLOG_ASSERT_INIT(SlogFirTreeLevels, Levels > 2 && SumW <= 32)
endmodule : slog_fir_tree
