// SPDX-License-Identifier: Apache-2.0
// Accumulates each lane's counts over a pass; total and count are bit-skewed: bit i is one clock after bit i-1.
//
//   total[k] = (first ? 0 : total[k]) + count[k] + extra[k]
//
// Slice i of a lane adds bit i of total and count and the registered carry of slice i-1; extra is slice 0's carry in.
//
// Stage  registers        valid at lane k, after the clock of extra_i
//   1    extra_q count_q  1 + k, bit i: 2 + k + i; they cover the distance from the lane to the sums near the output
//   2    carry_q[k][0]    2 + k: extra, delayed to meet count bit 0
//   2    first_q[k][i]    2 + k + i: a pass starts: the total is taken as 0
//   3    total_q[k][i]    3 + k + i
//
// Latency    : count bit i to total bit i: 2 clocks. Lane 0's count bit 0 and first_i arrive one clock after its extra.
// Throughput : one row per lane and clock. Everything holds while move_i is low.
// Formats    : total unsigned, never above 2**ScoreBits - 1 within a pass.
`include "slog_assert.svh"
module slog_accumulator #(
    parameter int unsigned CountBits = 4,
    parameter int unsigned ScoreBits = 9,
    parameter int unsigned Lanes     = 5
) (
    input  logic                 clk_i,
    input  logic                 move_i,
    input  logic                 first_i,
    input  logic                 extra_i[Lanes],
    input  logic [CountBits-1:0] count_i[Lanes],
    output logic [ScoreBits-1:0] total_o[Lanes]
);
  logic [ScoreBits-1:0] first_q[Lanes], total_q[Lanes], carry_q[Lanes];
  logic [CountBits-1:0] count_q[Lanes];
  logic                 extra_q[Lanes];

  always_ff @(posedge clk_i) begin
    if (move_i) begin
      count_q <= count_i;
      extra_q <= extra_i;
    end
  end

  always_ff @(posedge clk_i) begin
    if (move_i) begin
      static logic behind[Lanes];
      static logic [ScoreBits-1:0] first[Lanes];
      static logic [ScoreBits-1:0] total[Lanes];
      static logic [ScoreBits-1:0] carry[Lanes];
      behind[0] = first_i;
      /* verilator unroll_disable */
      for (int unsigned k = 1; k < Lanes; k++) behind[k] = first_q[k-1][0];
      /* verilator unroll_disable */
      for (int unsigned k = 0; k < Lanes; k++) begin
        first[k] = {first_q[k][ScoreBits-2:0], behind[k]};
        total[k] = (total_q[k] & ~first_q[k]) ^ ScoreBits'(count_q[k]) ^ carry_q[k];
        carry[k] = ScoreBits'({((total_q[k] & ~first_q[k]) & ScoreBits'(count_q[k])) |
                               (carry_q[k] & ((total_q[k] & ~first_q[k]) ^ ScoreBits'(count_q[k]))), extra_q[k]});
      end
      first_q <= first;
      total_q <= total;
      carry_q <= carry;
    end
  end
  assign total_o = total_q;

  `SLOG_ASSERT_INIT(SlogAccumulatorBits, CountBits < ScoreBits && Lanes >= 1)
endmodule : slog_accumulator
