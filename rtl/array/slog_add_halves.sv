// SPDX-License-Identifier: Apache-2.0
// Registered full adders in every lane: each adds one bit of either half of a word and a carry.
//
//   2 * carry_o[k] + sum_o[k] = bits_i[k][Width-1:0] + bits_i[k][2*Width-1:Width] + carry_i[k]     (bit by bit)
//
// Latency    : 1 clock in which move_i is high; outputs hold while it is low.
// Throughput : Width additions per lane and clock.
module slog_add_halves #(
    parameter int unsigned Width = 4,
    parameter int unsigned Lanes = 5
) (
    input  logic               clk_i,
    input  logic               move_i,
    input  logic [2*Width-1:0] bits_i[Lanes],
    input  logic [Width-1:0]   carry_i[Lanes],
    output logic [Width-1:0]   sum_o[Lanes],
    output logic [Width-1:0]   carry_o[Lanes]
);
  logic [Width-1:0] sum_q[Lanes], carry_q[Lanes];

  always_ff @(posedge clk_i) begin
    if (move_i) begin
      static logic [Width-1:0] sum[Lanes];
      static logic [Width-1:0] carry[Lanes];
      /* verilator unroll_disable */
      for (int unsigned k = 0; k < Lanes; k++) begin
        sum[k] = bits_i[k][Width-1:0] ^ bits_i[k][2*Width-1:Width] ^ carry_i[k];
        carry[k] = (bits_i[k][Width-1:0] & bits_i[k][2*Width-1:Width]) |
                   (carry_i[k] & (bits_i[k][Width-1:0] ^ bits_i[k][2*Width-1:Width]));
      end
      sum_q   <= sum;
      carry_q <= carry;
    end
  end
  assign sum_o   = sum_q;
  assign carry_o = carry_q;
endmodule : slog_add_halves
