// SPDX-License-Identifier: Apache-2.0
// Output-stationary systolic XOR/popcount array: each lane scores one horizontal offset of a window.
//
//   mismatch[k] = sum over the pass's rows and both groups of popcount((tpl ^ search[GroupBits-1+k : k]) & mask)
//
// A pass is a run of operand rows (first .. last) with any number of invalid clocks between; passes follow one another
// without a gap. Group B's bits of mask_i are mask_i[2*GroupBits-1:GroupBits].
//
// Stage                 registers              valid at lane k, bit i after the operands' clock (L = Levels)
//   hop, XOR            slog_lanes             2 + k
//   tree of adders      slog_popcount          2 + L + k + i
//   sum over rows       slog_accumulator       4 + L + k + i
//   lane selection      slog_emit              7 + L + k + i
//   deskewed score      mismatch_o             6 + L + ScoreBits + k = slog_array_pkg::core_latency + k
//
// Throughput : one operand row of both groups per clock; one score per clock.
// Rules      : operands that must not count are 0: all of them in clocks without valid_i (from the second clock after
//              reset on), group B's in a last row without row B. The last row of a pass follows that of the pass
//              before by at least that pass's lanes_i clocks. While move_i is low all registers hold and operands are
//              ignored; slog_operands holds move_i high until the array is empty. Counted in clocks with move_i, mask_i
//              is stable for Lanes clocks after a clock with valid_i.
// Simulation : each lane's bits share one word, and the work is in loops over lanes that Verilator keeps as loops
//              (unroll_disable) so that the compiler vectorises them. Scratch arrays are static so that entering the
//              block does not clear them. With move_i low no work is done.
// Formats    : mismatch unsigned, 0..(2*GroupBits)**2 (slog_peak_intake asserts it against the window's area); 0 while
//              mismatch_valid_o is low, see slog_emit for reset.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_array #(
    parameter  int unsigned GroupBits  = 8,
    parameter  int unsigned Lanes      = 5,
    localparam int unsigned SearchBits = GroupBits + Lanes - 1,
    localparam int unsigned LaneW      = $clog2(Lanes + 1),
    localparam int unsigned ScoreBits  = slog_array_pkg::score_bits(GroupBits)
) (
    input  logic                   clk_i,
    input  logic                   rst_i,
    input  logic                   move_i,
    input  logic [2*GroupBits-1:0] mask_i,
    input  logic                   valid_i,
    input  logic                   first_i,
    input  logic                   last_i,
    input  logic [LaneW-1:0]       lanes_i,
    input  logic [GroupBits-1:0]   tpl_a_i,
    input  logic [GroupBits-1:0]   tpl_b_i,
    input  logic [SearchBits-1:0]  search_a_i,
    input  logic [SearchBits-1:0]  search_b_i,
    output logic                   mismatch_valid_o,
    output logic [ScoreBits-1:0]   mismatch_o
);
  localparam int unsigned Levels    = slog_array_pkg::levels(GroupBits);
  localparam int unsigned CountBits = Levels + 1;

  logic [GroupBits-1:0] x_a[Lanes], x_b[Lanes];
  logic [CountBits-1:0] count[Lanes];
  logic                 extra[Lanes];
  logic [ScoreBits-1:0] total[Lanes];

  slog_lanes #(.GroupBits(GroupBits), .Lanes(Lanes)) u_lanes_a (
      .clk_i, .move_i, .tpl_i(tpl_a_i), .search_i(search_a_i), .mask_i(mask_i[GroupBits-1:0]), .x_o(x_a)
  );
  slog_lanes #(.GroupBits(GroupBits), .Lanes(Lanes)) u_lanes_b (
      .clk_i, .move_i, .tpl_i(tpl_b_i), .search_i(search_b_i), .mask_i(mask_i[2*GroupBits-1:GroupBits]), .x_o(x_b)
  );
  slog_popcount #(.GroupBits(GroupBits), .Lanes(Lanes)) u_popcount (
      .clk_i, .move_i, .a_i(x_a), .b_i(x_b), .count_o(count), .extra_o(extra)
  );

  // Delays the control bits to match bit 0 of lane 0's count.
  logic [Levels+1:0] first_q;
  logic [Levels+2:0] last_q;
  logic [Levels+2:0][LaneW-1:0] lanes_q;
  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      first_q <= '0;
      last_q  <= '0;
    end else if (move_i) begin
      first_q <= {first_q[Levels:0], valid_i && first_i};
      last_q  <= {last_q[Levels+1:0], valid_i && last_i};
    end
  end
  always_ff @(posedge clk_i) begin
    if (move_i) begin
      lanes_q <= {lanes_q[Levels+1:0], lanes_i};
    end
  end

  slog_accumulator #(.CountBits(CountBits), .ScoreBits(ScoreBits), .Lanes(Lanes)) u_accumulator (
      .clk_i, .move_i, .first_i(first_q[Levels+1]), .extra_i(extra), .count_i(count), .total_o(total)
  );
  slog_emit #(.ScoreBits(ScoreBits), .Lanes(Lanes)) u_emit (
      .clk_i, .rst_i, .move_i, .last_i(last_q[Levels+2]), .lanes_i(lanes_q[Levels+2]), .total_i(total),
      .mismatch_valid_o, .mismatch_o
  );

`ifndef SYNTHESIS
  int unsigned moves_since_valid;
  always_ff @(posedge clk_i) begin
    if (rst_i) moves_since_valid <= Lanes;
    else if (move_i) moves_since_valid <= valid_i ? 0 : moves_since_valid + 1;
  end
`endif
  `SLOG_ASSERT_INIT(SlogArraySizes, GroupBits == 2 ** Levels && Lanes >= 2)
  `SLOG_PAST(past_rst, rst_i)
  `SLOG_PAST(past_mask, mask_i)
  `SLOG_ASSERT(SlogArrayZero, valid_i || !move_i || past_rst
                              || ({tpl_a_i, tpl_b_i} == '0 && {search_a_i, search_b_i} == '0))
  `SLOG_ASSERT(SlogArrayMaskStatic, mask_i == past_mask || moves_since_valid >= Lanes)
endmodule : slog_array
