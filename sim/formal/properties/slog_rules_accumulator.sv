// slog_accumulator against a plain sum, in lane 0. History counts clocks in which move_i is high.
module slog_rules_accumulator #(
    parameter int unsigned CountBits = 2,
    parameter int unsigned ScoreBits = 4,
    parameter int unsigned Lanes     = 1
) (
    input logic                 clk_i,
    input logic                 move_i,
    input logic                 first_i,
    input logic                 extra_i[Lanes],
    input logic [CountBits-1:0] count_i[Lanes],
    input logic [ScoreBits-1:0] total_o[Lanes]
);
  localparam int unsigned Deep = 2 * ScoreBits;
  // [k]: k + 1 moves ago
  logic [Deep-1:0] first_q, extra_q, known_q;
  logic [CountBits-1:0][Deep-1:0] count_q;
  logic [ScoreBits-1:0][Deep-1:0] total_q;
  logic [Deep-1:0][ScoreBits-1:0] sum_q;
  logic [ScoreBits-1:0] count, sum, found;
  logic known = 1'b0;  // a pass has begun
  logic [4:0] moves_q = '0;
  // A row's extra comes first, bit i of its count i + 1 moves later. With its top bit the row is complete.
  always_comb begin
    count = '0;
    for (int unsigned i = 0; i < CountBits; i++) begin
      count[i] = (i == CountBits - 1) ? count_i[0][i] : count_q[i][CountBits-2-i];
    end
    sum = (((CountBits == 1) ? first_i : first_q[CountBits-2]) ? '0 : sum_q[0]) + count
          + ScoreBits'(extra_q[CountBits-1]);
    found = '0;
    for (int unsigned i = 0; i < ScoreBits; i++) begin
      found[i] = (i == ScoreBits - 1) ? total_o[0][i] : total_q[i][ScoreBits-2-i];
    end
  end
  always_ff @(posedge clk_i) begin
    if (move_i) begin
      first_q <= {first_q[Deep-2:0], first_i};
      extra_q <= {extra_q[Deep-2:0], extra_i[0]};
      for (int unsigned i = 0; i < CountBits; i++) count_q[i] <= {count_q[i][Deep-2:0], count_i[0][i]};
      for (int unsigned i = 0; i < ScoreBits; i++) total_q[i] <= {total_q[i][Deep-2:0], total_o[0][i]};
      sum_q   <= {sum_q[Deep-2:0], sum};
      known   <= known || (32'(moves_q) > CountBits && first_q[CountBits-2]);
      known_q <= {known_q[Deep-2:0], known};
      if (moves_q != '1) moves_q <= moves_q + 1'b1;
    end
    // Bit 0 of a row's total appears three moves after its extra, its top bit ScoreBits - 1 moves later; the sum is
    // registered CountBits + 1 moves after its extra.
    RulesAccumulator : assert (32'(moves_q) <= 2 * ScoreBits + 2 || !known_q[ScoreBits]
                               || found == sum_q[ScoreBits+2-CountBits-1]);
    CoverSum : cover (32'(moves_q) > 2 * ScoreBits + 2 && known_q[ScoreBits] && found == '1);
  end
endmodule : slog_rules_accumulator

bind slog_accumulator slog_rules_accumulator #(.CountBits(CountBits), .ScoreBits(ScoreBits), .Lanes(Lanes)) u_rules (.*);
