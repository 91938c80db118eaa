// SPDX-License-Identifier: Apache-2.0
// Outputs the lanes' totals, one per clock: lane k's total is complete one clock after lane k-1's.
//
//   mismatch = total of lane 0, 1, .. lanes-1, in that order
//
// Stage  registers   valid after the clock of last_i (bit 0 of lane 0; bit i of lane k: + i + k)
//   1    token_q     1: selects the total bit that is taken in that clock
//   2    pair_q      2: AND-OR of two lanes, neighbours so that their wires are short
//   3    few_q       3: OR of four neighbouring pairs
//   4    word_q      4: OR of all
//   -    early_q     3 + ScoreBits: deskew, delays the lower bits to match the top one
//
// Latency    : last_i to mismatch_valid_o of lane 0: 3 + ScoreBits clocks.
// Throughput : one score per clock; last_i follows the last_i before it by at least that one's lanes_i clocks.
// Reset      : rst_i is held for 1 clock or more. No new token is made; tokens in flight shift out within ScoreBits
//              clocks, before a new pass can end.
// Formats    : mismatch unsigned; lanes_i 1..Lanes. mismatch_o is 0 while mismatch_valid_o is low, from ScoreBits + 3
//              clocks with move_i high after a reset on.
`include "slog_assert.svh"
module slog_emit #(
    parameter  int unsigned ScoreBits = 9,
    parameter  int unsigned Lanes     = 5,
    localparam int unsigned LaneW     = $clog2(Lanes + 1)
) (
    input  logic                 clk_i,
    input  logic                 rst_i,
    input  logic                 move_i,
    input  logic                 last_i,
    input  logic [LaneW-1:0]     lanes_i,
    input  logic [ScoreBits-1:0] total_i[Lanes],
    output logic                 mismatch_valid_o,
    output logic [ScoreBits-1:0] mismatch_o
);
  localparam int unsigned Pairs = (Lanes + 1) / 2;
  localparam int unsigned Fews  = (Pairs + 3) / 4;

  // left_q: lanes still to be selected after the present one; counts down past zero. more_q: there are such lanes.
  // One copy for every Reach lanes, each one clock behind the copy before it; the token takes longer to reach them.
  localparam int unsigned Reach  = 4;  // lanes that one copy serves
  localparam int unsigned Copies = (Lanes + Reach - 1) / Reach;
  logic [Copies-1:0][LaneW-1:0] left_q;
  logic [Copies-1:0] more_q;
  logic [ScoreBits+2:0] valid_q;

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      more_q  <= '0;
      valid_q <= '0;
    end else if (move_i) begin
      valid_q   <= {valid_q[ScoreBits+1:0], last_i || more_q[0]};
      more_q[0] <= last_i ? lanes_i != LaneW'(1) : more_q[0] && left_q[0] != LaneW'(1);
      for (int unsigned c = 1; c < Copies; c++) more_q[c] <= more_q[c-1] && left_q[c-1] != LaneW'(1);
    end
  end
  always_ff @(posedge clk_i) begin
    if (move_i) begin
      left_q[0] <= last_i ? lanes_i - 1'b1 : left_q[0] - 1'b1;
      for (int unsigned c = 1; c < Copies; c++) left_q[c] <= left_q[c-1] - 1'b1;
    end
  end

  logic [ScoreBits-1:0] token_q[Lanes], pair_q[4*Fews], few_q[Fews], word_q;

  always_ff @(posedge clk_i) begin
    if (move_i) begin
      static logic behind[Lanes];
      static logic [ScoreBits-1:0] token[Lanes];
      behind[0] = last_i;
      /* verilator unroll_disable */
      for (int unsigned k = 1; k < Lanes; k++) behind[k] = token_q[k-1][0] & more_q[k/Reach];
      /* verilator unroll_disable */
      for (int unsigned k = 0; k < Lanes; k++) token[k] = {token_q[k][ScoreBits-2:0], behind[k]};
      token_q <= token;
    end
  end

  always_ff @(posedge clk_i) begin
    if (move_i) begin
      static logic [ScoreBits-1:0] taken[2*Pairs];
      static logic [ScoreBits-1:0] pair[4*Fews];
      static logic [ScoreBits-1:0] few[Fews];
      static logic [ScoreBits-1:0] word;
      taken[2*Pairs-1] = '0;
      /* verilator unroll_disable */
      for (int unsigned k = 0; k < Lanes; k++) taken[k] = total_i[k] & token_q[k];
      for (int unsigned p = Pairs; p < 4 * Fews; p++) pair[p] = '0;
      /* verilator unroll_disable */
      for (int unsigned p = 0; p < Pairs; p++) pair[p] = taken[2*p] | taken[2*p+1];
      for (int unsigned f = 0; f < Fews; f++) begin
        few[f] = pair_q[4*f] | pair_q[4*f+1] | pair_q[4*f+2] | pair_q[4*f+3];
      end
      word = '0;
      for (int unsigned f = 0; f < Fews; f++) word |= few_q[f];
      pair_q <= pair;
      few_q  <= few;
      word_q <= word;
    end
  end

  for (genvar i = 0; i < ScoreBits; i++) begin : g_deskew
    logic [i:0] bits;
    if (i == 0) begin : g_bits
      assign bits = word_q[0];
    end else begin : g_bits
      logic [i-1:0] early_q;
      always_ff @(posedge clk_i) begin
        if (move_i) early_q <= g_deskew[i-1].bits;
      end
      assign bits = {word_q[i], early_q};
    end
  end

  assign mismatch_valid_o = valid_q[ScoreBits+2];
  assign mismatch_o       = g_deskew[ScoreBits-1].bits;

  `SLOG_ASSERT(SlogEmitOnePass, !(last_i && move_i && more_q[0]))
  `SLOG_ASSERT(SlogEmitLanes, !(last_i && move_i) || (lanes_i != '0 && lanes_i <= LaneW'(Lanes)))

`ifndef SYNTHESIS
  int unsigned moves_since_reset;
  always_ff @(posedge clk_i) begin
    if (rst_i) moves_since_reset <= 0;
    else if (move_i && moves_since_reset <= ScoreBits + 3) moves_since_reset <= moves_since_reset + 1;
  end
`endif
  `SLOG_ASSERT(SlogEmitZero, mismatch_valid_o || mismatch_o == '0 || moves_since_reset < ScoreBits + 3)
endmodule : slog_emit
