// SPDX-License-Identifier: Apache-2.0
// `slog_reset_buffer` on the ECP5: one of the global networks that carry clocks carries the reset to the registers.
//
// Latency    : that of ../cells/slog_reset_buffer.sv. The network delays the reset about as much as the clock.
module slog_reset_buffer (
    input  logic rst_i,
    output logic rst_o
);
  DCCA u_global (.CLKI(rst_i), .CE(1'b1), .CLKO(rst_o));
endmodule : slog_reset_buffer
