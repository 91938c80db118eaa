// SPDX-License-Identifier: Apache-2.0
// Drives the reset net of the whole board: a plain wire.
//
// Latency    : none.
// Twin       : ecp5/slog_reset_buffer.sv is the same module on one of the ECP5's global networks.
module slog_reset_buffer (
    input  logic rst_i,
    output logic rst_o
);
  assign rst_o = rst_i;
endmodule : slog_reset_buffer
