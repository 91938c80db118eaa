// SPDX-License-Identifier: Apache-2.0
// Funnel shifter: turns the store words of a row into words that begin at the row's first bit.
//
//   out word k = {store word k+1, store word k}[shift + Width - 1 : shift]
//
//   stage  registers
//   0      store word k, shift, side
//   1      the pair of words shifted by the two high bits of the shift: Width + Width/4 - 1 bits remain
//   2..    shifted by two more bits of the shift in each stage
//   last   output register
// Latency    : 2 + ceil(log2(Width) / 2) clocks from in_valid_i to out_valid_o; words without in_emit_i have no output.
// Throughput : one word per clock.
// Rule       : the words of a row arrive in consecutive clocks. In the clock after the last word in_data_i
//              need not belong to the row: output bits past the row's last store word are undefined.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_align #(
    parameter  int unsigned Width   = 64,
    parameter  int unsigned SideW   = 8,
    localparam int unsigned ShiftW  = $clog2(Width),
    localparam int unsigned Stages  = (ShiftW + 1) / 2,
    localparam int unsigned Latency = 2 + Stages
) (
    input  logic              clk_i,
    input  logic              rst_i,
    input  logic              in_valid_i,
    input  logic              in_emit_i,   // an aligned word begins in this store word
    input  logic [Width-1:0]  in_data_i,
    input  logic [ShiftW-1:0] in_shift_i,
    input  logic [SideW-1:0]  in_side_i,
    output logic              out_valid_o,
    output logic [Width-1:0]  out_data_o,
    output logic [SideW-1:0]  out_side_o
);
  localparam int unsigned PadW = 2 * Stages;  // shift bits, rounded up to an even number

  logic [Latency-1:0] valid_q;
  logic [Width-1:0] low_q;
  logic [2*Width-1:0] stage_q[Stages];
  logic [PadW-1:0] shift_q[Stages];
  logic [SideW-1:0] side_q[Latency];
  logic [Width-1:0] out_q;

  always_ff @(posedge clk_i) begin
    if (rst_i) valid_q <= '0;
    else valid_q <= {valid_q[Latency-2:0], in_valid_i && in_emit_i};
  end

  always_ff @(posedge clk_i) begin
    low_q      <= in_data_i;
    shift_q[0] <= PadW'(in_shift_i);
    side_q[0]  <= in_side_i;
    // No enable, as for the words: the registers may be spread over the device.
    for (int unsigned s = 1; s < Latency; s++) side_q[s] <= side_q[s-1];
    for (int unsigned s = 1; s < Stages; s++) shift_q[s] <= shift_q[s-1];
    out_q <= stage_q[Stages-1][Width-1:0];
  end

  for (genvar s = 0; s < Stages; s++) begin : g_stage
    localparam int unsigned Low = PadW - 2 - 2 * s;  // lowest shift bit of this stage
    // Bits that later stages can still reach; those above are constant zero.
    localparam int unsigned Keep = Width + (1 << Low) - 1;
    logic [2*Width-1:0] wide, narrow;
    if (s == 0) begin : g_pair
      assign wide = {in_data_i, low_q};
    end else begin : g_next
      assign wide = stage_q[s-1];
    end
    if (s == 0) begin : g_halves
      // The first two bits of the shift have a large fan-out: the upper half uses an inverted copy of them.
      logic [1:0] opposite_q;
      /* verilator lint_off UNUSEDSIGNAL */
      logic [2*Width-1:0] low, high;
      /* verilator lint_on UNUSEDSIGNAL */
      always_ff @(posedge clk_i) opposite_q <= ~2'(PadW'(in_shift_i) >> Low);
      assign low    = wide >> (PadW'(shift_q[s][Low+:2]) << Low);
      assign high   = wide >> (PadW'(~opposite_q) << Low);
      assign narrow = {high[2*Width-1:Keep/2], low[Keep/2-1:0]} & ({(2 * Width) {1'b1}} >> (2 * Width - Keep));
    end else begin : g_whole
      assign narrow = (wide >> (PadW'(shift_q[s][Low+:2]) << Low)) & ({(2 * Width) {1'b1}} >> (2 * Width - Keep));
    end
    always_ff @(posedge clk_i) stage_q[s] <= narrow;
  end

  assign out_valid_o = valid_q[Latency-1];
  assign out_data_o  = out_q;
  assign out_side_o  = side_q[Latency-1];

  `SLOG_ASSERT_INIT(SlogAlignPowerOfTwo, Width == 2 ** ShiftW && ShiftW >= 2)
endmodule : slog_align
