// Counts the ones of both groups in every lane, all but group A's bit 0, by a heap of registered full adders.
//
//   count[k] = sum of b_i[*][k] + sum of a_i[1..][k]
//
// Node n of the heap (1 = root) adds its children 2n and 2n+1 and, as carry in, group A's bit n; the leaves
// GroupBits..2*GroupBits-1 are group B's bits. A node of level l adds two l-bit numbers; numbers travel skewed, bit i
// one clock after bit i-1, so every carry takes a clock and there is one full adder between registers.
//
// Latency    : count bit i is valid Levels + i clocks after b_i; a_i[n] must come levels - bits(n) clocks after b_i.
// Throughput : one count per lane and clock. Everything holds while move_i is low.
// Formats    : count unsigned, 0..2*GroupBits-1.
module slog_popcount #(
    parameter  int unsigned GroupBits = 8,
    parameter  int unsigned Lanes     = 5,
    localparam int unsigned Levels    = slog_array_pkg::levels(GroupBits)
) (
    input  logic             clk_i,
    input  logic             move_i,
    input  logic [Lanes-1:0] a_i[1:GroupBits-1],
    input  logic [Lanes-1:0] b_i[GroupBits],
    output logic [Lanes-1:0] count_o[Levels+1]
);
  for (genvar n = 1; n < 2 * GroupBits; n++) begin : g_node
    localparam int unsigned Level = Levels + 1 - $clog2(n + 1);
    for (genvar i = 0; i <= Level; i++) begin : g_bit
      logic [Lanes-1:0] value;
      if (Level == 0) begin : g_leaf
        assign value = b_i[n-GroupBits];
      end else if (i < Level) begin : g_add
        logic [Lanes-1:0] carry_in, carry;
        if (i == 0) begin : g_carry
          assign carry_in = a_i[n];
        end else begin : g_carry
          assign carry_in = g_node[n].g_bit[i-1].g_add.carry;
        end
        slog_full_adder #(.Lanes(Lanes)) u_adder (
            .clk_i,
            .move_i,
            .a_i    (g_node[2*n].g_bit[i].value),
            .b_i    (g_node[2*n+1].g_bit[i].value),
            .c_i    (carry_in),
            .sum_o  (value),
            .carry_o(carry)
        );
      end else begin : g_top
        always_ff @(posedge clk_i) begin
          if (move_i) value <= g_node[n].g_bit[i-1].g_add.carry;
        end
      end
    end
  end

  for (genvar i = 0; i <= Levels; i++) begin : g_count
    assign count_o[i] = g_node[1].g_bit[i].value;
  end
endmodule : slog_popcount
