// Registered full adder, one per lane: carry_o * 2 + sum_o = a_i + b_i + c_i.
//
// Latency    : 1 clock in which move_i is high; outputs hold while it is low.
// Throughput : one addition per lane and clock.
module slog_full_adder #(
    parameter int unsigned Lanes = 5
) (
    input  logic             clk_i,
    input  logic             move_i,
    input  logic [Lanes-1:0] a_i,
    input  logic [Lanes-1:0] b_i,
    input  logic [Lanes-1:0] c_i,
    output logic [Lanes-1:0] sum_o,
    output logic [Lanes-1:0] carry_o
);
  always_ff @(posedge clk_i) begin
    if (move_i) begin
      sum_o   <= a_i ^ b_i ^ c_i;
      carry_o <= (a_i & b_i) | (c_i & (a_i ^ b_i));
    end
  end
endmodule : slog_full_adder
