// A few bits of every unit of the search ring's words, on their way from the memories to the operand rows.
//
//   a = units chunk .. chunk+2 of the row of parity odd_a        b = likewise of odd_b, two units further on if wide
//
// A unit is half a word. The choice is the same for every bit of a unit, so the ring is cut into slices across the units,
// each with registers of its own for what chooses: no net has to reach all words.
//
// Stage  registers          valid after the clock of odd_a_i .. chunk_i
//   1    what chooses       1, with word_i in that clock
//   2    a_q2[3] b_q2[4]    2: words from the first quad on: rows and quads in place
//   3    a_q3[2] b_q3[2]    3: words from the first unit's on
//   4    a_o b_o            4: units in place; zero unless keep_a_i, keep_b_i were high two clocks before
//
// Throughput : one choice per clock.
module slog_ring_slice #(
    parameter  int unsigned UnitBits = 4,
    localparam int unsigned WordBits = 2 * UnitBits
) (
    input  logic                           clk_i,
    input  logic                           odd_a_i,
    input  logic                           odd_b_i,
    input  logic                           wide_i,
    input  logic [2:0]                     chunk_i,
    input  logic                           keep_a_i,
    input  logic                           keep_b_i,
    input  logic [7:0][WordBits-1:0]       word_i,  // [{row parity, quad parity, word parity}]
    output logic [WordBits+UnitBits-1:0]   a_o,
    output logic [WordBits+UnitBits-1:0]   b_o
);
  logic odd_a_q, odd_b_q, wide_q, wide_q2, chunk_q3, keep_a_q, keep_b_q;
  logic [2:0] chunk_q;
  logic [1:0] chunk_q2;
  logic [WordBits-1:0] a_q2[3], b_q2[4], a_q3[2], b_q3[2];

  always_ff @(posedge clk_i) begin
    odd_a_q  <= odd_a_i;
    odd_b_q  <= odd_b_i;
    wide_q   <= wide_i;
    wide_q2  <= wide_q;
    chunk_q  <= chunk_i;
    chunk_q2 <= chunk_q[1:0];
    chunk_q3 <= chunk_q2[0];
    keep_a_q <= keep_a_i;
    keep_b_q <= keep_b_i;

    a_q2[0] <= word_i[{odd_a_q, chunk_q[2], 1'b0}];
    a_q2[1] <= word_i[{odd_a_q, chunk_q[2], 1'b1}];
    a_q2[2] <= word_i[{odd_a_q, !chunk_q[2], 1'b0}];
    b_q2[0] <= word_i[{odd_b_q, chunk_q[2], 1'b0}];
    b_q2[1] <= word_i[{odd_b_q, chunk_q[2], 1'b1}];
    b_q2[2] <= word_i[{odd_b_q, !chunk_q[2], 1'b0}];
    b_q2[3] <= word_i[{odd_b_q, !chunk_q[2], 1'b1}];

    a_q3[0] <= chunk_q2[1] ? a_q2[1] : a_q2[0];
    a_q3[1] <= chunk_q2[1] ? a_q2[2] : a_q2[1];
    if (chunk_q2[1] && wide_q2) begin
      b_q3[0] <= b_q2[2];
      b_q3[1] <= b_q2[3];
    end else if (chunk_q2[1] || wide_q2) begin
      b_q3[0] <= b_q2[1];
      b_q3[1] <= b_q2[2];
    end else begin
      b_q3[0] <= b_q2[0];
      b_q3[1] <= b_q2[1];
    end

    if (!keep_a_q) a_o <= '0;
    else if (chunk_q3) a_o <= {a_q3[1], a_q3[0][WordBits-1:UnitBits]};
    else a_o <= {a_q3[1][UnitBits-1:0], a_q3[0]};
    if (!keep_b_q) b_o <= '0;
    else if (chunk_q3) b_o <= {b_q3[1], b_q3[0][WordBits-1:UnitBits]};
    else b_o <= {b_q3[1][UnitBits-1:0], b_q3[0]};
  end
endmodule : slog_ring_slice
