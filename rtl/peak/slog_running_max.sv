// SPDX-License-Identifier: Apache-2.0
// Finds the largest value of each row of a stream, and its index; of equal values, the one with the smallest index.
//
// Odd and even samples have separate running maxima, so that the comparison can take a full clock before the update:
//   A  inputs: compare with the maximum of the same parity      B  update
//   C  compare the two maxima                                   D  output
// Latency    : out_valid_o three clocks after in_valid_i with in_last_i.
// Throughput : one sample per clock, rows back to back, gaps allowed. A row of one sample has first and last together.
// Formats    : values and indices unsigned; indices never fall within a row.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_running_max
  import slog_compare_pkg::*;
#(
    parameter int unsigned ValueW = 15,
    parameter int unsigned IndexW = 10
) (
    input  logic              clk_i,
    input  logic              rst_i,
    input  logic              in_valid_i,
    input  logic              in_first_i,
    input  logic              in_last_i,
    input  logic [ValueW-1:0] in_value_i,
    input  logic [IndexW-1:0] in_index_i,
    output logic              out_valid_o,
    output logic [ValueW-1:0] out_value_o,
    output logic [IndexW-1:0] out_index_o
);
  logic odd, odd_q, second_q;          // parity of this sample; of the next one; the next one is the second of its row
  logic [1:0] load_q, try_q, take;     // B, per parity: load the sample; load it if it is greater; either holds
  logic [1:0] above_q;                 // B: the sample is greater than the maximum of this parity
  logic [ValueW-1:0] b_value_q, max_q[2], d_value_q[2];
  logic [IndexW-1:0] b_index_q, index_q[2], d_index_q[2];
  logic b_last_q, b_single_q, c_last_q, c_single_q, d_last_q, d_pair_q, d_odd_q, odd_wins;

  `SLOG_ASSERT_INIT(SlogRunningMaxWidth, ValueW + IndexW <= 32)

  assign odd = odd_q && !in_first_i;
  always_comb begin
    for (int p = 0; p < 2; p++) take[p] = load_q[p] || (try_q[p] && above_q[p]);
  end

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      load_q   <= '0;
      try_q    <= '0;
      b_last_q <= 1'b0;
      c_last_q <= 1'b0;
      d_last_q <= 1'b0;
    end else begin
      // The first sample of each parity is loaded without comparison.
      load_q   <= {in_valid_i && second_q && !in_first_i, in_valid_i && in_first_i};
      try_q    <= {in_valid_i && odd, in_valid_i && !odd};
      b_last_q <= in_valid_i && in_last_i;
      c_last_q <= b_last_q;
      d_last_q <= c_last_q;
    end
  end

  always_ff @(posedge clk_i) begin
    if (in_valid_i) begin
      odd_q      <= !odd;
      second_q   <= in_first_i;
      b_value_q  <= in_value_i;
      b_index_q  <= in_index_i;
      b_single_q <= in_first_i;
    end
    for (int p = 0; p < 2; p++) begin
      if (in_valid_i) above_q[p] <= is_above(32'(in_value_i), 32'(max_q[p]));
      if (take[p]) begin
        max_q[p]   <= b_value_q;
        index_q[p] <= b_index_q;
      end
    end
    c_single_q <= b_single_q;
    if (c_last_q) begin
      d_value_q <= max_q;
      d_index_q <= index_q;
      d_pair_q  <= !c_single_q;
      // Of equal values the smaller index wins: each value has the other one's index as its low bits.
      d_odd_q   <= is_above(32'({max_q[1], index_q[0]}), 32'({max_q[0], index_q[1]}));
    end
  end

  assign odd_wins    = d_pair_q && d_odd_q;
  assign out_valid_o = d_last_q;
  assign out_value_o = odd_wins ? d_value_q[1] : d_value_q[0];
  assign out_index_o = odd_wins ? d_index_q[1] : d_index_q[0];

  `SLOG_ASSERT(SlogRunningMaxIndices, !in_valid_i || in_first_i || in_index_i >= b_index_q)
endmodule : slog_running_max
