// SPDX-License-Identifier: Apache-2.0
// Passes one operand group from lane to lane and compares template and search bits in each lane.
//
//   x[k] = (tpl ^ search[GroupBits-1+k : k]) & mask     for lane k
//
// Template and search row enter lane 0 together and move on by one lane per clock; the search row is shifted by one bit
// per lane, and ahead_q carries the bits that are still to be shifted in.
//
// Stage  registers                valid at lane k after the operands' clock
//   1    tpl_q search_q ahead_q   1 + k; mask_q[k / 4] is the copy of the mask for four lanes
//   2    x_q                      2 + k
//
// Throughput : one operand row per clock. Everything holds while move_i is low.
// Borders    : mask_i is static while operands are in flight (asserted in slog_array); a bit with mask 0 never counts.
//              The mask moves on by four lanes per clock, faster than the operands, so that no net spans the array.
`include "slog_assert.svh"
module slog_lanes #(
    parameter  int unsigned GroupBits  = 8,
    parameter  int unsigned Lanes      = 5,
    localparam int unsigned SearchBits = GroupBits + Lanes - 1,
    localparam int unsigned MaskHops   = (Lanes + 3) / 4
) (
    input  logic                  clk_i,
    input  logic                  move_i,
    input  logic [GroupBits-1:0]  tpl_i,
    input  logic [SearchBits-1:0] search_i,
    input  logic [GroupBits-1:0]  mask_i,
    output logic [GroupBits-1:0]  x_o[Lanes]
);
  logic [GroupBits-1:0] tpl_q[Lanes], search_q[Lanes], x_q[Lanes];
  logic [Lanes-2:0] ahead_q[Lanes];
  logic [GroupBits-1:0] mask_q[MaskHops];

  always_ff @(posedge clk_i) begin
    if (move_i) begin
      static logic [GroupBits-1:0] tpl[Lanes];
      static logic [GroupBits-1:0] search[Lanes];
      static logic [GroupBits-1:0] x[Lanes];
      static logic [Lanes-2:0] ahead[Lanes];
      static logic [GroupBits-1:0] mask[MaskHops];
      mask[0] = mask_i;
      for (int unsigned h = 1; h < MaskHops; h++) mask[h] = mask_q[h-1];
      tpl[0]    = tpl_i;
      search[0] = search_i[GroupBits-1:0];
      ahead[0]  = search_i[SearchBits-1:GroupBits];
      /* verilator unroll_disable */
      for (int unsigned k = 1; k < Lanes; k++) begin
        tpl[k]    = tpl_q[k-1];
        search[k] = {ahead_q[k-1][0], search_q[k-1][GroupBits-1:1]};
        ahead[k]  = ahead_q[k-1] >> 1;
      end
      /* verilator unroll_disable */
      for (int unsigned k = 0; k < Lanes; k++) x[k] = (tpl_q[k] ^ search_q[k]) & mask_q[k/4];
      tpl_q    <= tpl;
      search_q <= search;
      ahead_q  <= ahead;
      mask_q   <= mask;
      x_q      <= x;
    end
  end
  assign x_o = x_q;

  `SLOG_ASSERT_INIT(SlogLanesLanes, Lanes >= 2)
endmodule : slog_lanes
