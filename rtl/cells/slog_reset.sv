// SPDX-License-Identifier: Apache-2.0
// The board's reset from its pin to all registers: registers at both ends of the way, then a buffer for the net that spans
// the whole board. The reset is made longer: a pulse of one clock resets the blocks for Held clocks.
//
// Rule       : a block resets its state and the flags that change it. Flags without reset that follow those within a few
//              clocks settle while the reset is still held: Held is one more than the longest chain of them whose end
//              steers anything (three registers: the column, end of line and end of frame of slog_video_in, and the
//              load flags of slog_taps_slice). Longer chains without reset carry only data, or accesses to memory words
//              that are written before they are read. Each module's header gives the clocks for which its own rst_i
//              must be held.
// Latency    : 4 clocks to the reset, 3 + Held clocks to its end. All registers are set at power-up, so the board starts
//              in reset.
`include "slog_assert.svh"
module slog_reset #(
    parameter int unsigned Held = 4
) (
    input  logic clk_i,
    input  logic rst_i,
    output logic rst_o
);
  logic            rst_q = 1'b1;
  logic            rst_q2 = 1'b1;
  logic [Held-2:0] past_q = '1;  // [k]: rst_q2 k + 1 clocks before
  logic            rst_q3 = 1'b1;
  logic            rst_q4 = 1'b1;  // before the buffer, without logic: blocks it does not reach have copies of it

  always_ff @(posedge clk_i) begin
    rst_q  <= rst_i;
    rst_q2 <= rst_q;
    past_q <= (Held - 1)'({past_q, rst_q2});
    rst_q3 <= rst_q2 || past_q != '0;
    rst_q4 <= rst_q3;
  end

  slog_reset_buffer u_buffer (.rst_i(rst_q4), .rst_o);

  `SLOG_ASSERT_INIT(SlogResetHeld, Held >= 2)
endmodule : slog_reset
