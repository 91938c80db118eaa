// SPDX-License-Identifier: Apache-2.0
// A few bits of slog_packer's word, with their own registers for the pixel and its place: the slices lie far apart.
//
//   stage  registers
//   1      pixel, whether its place moves
//   2      pixel, its place
//   3      word_o
// Throughput : one pixel per clock.
module slog_packer_slice #(
    parameter int unsigned Bits = 16
) (
    input  logic            clk_i,
    input  logic            valid_i,
    input  logic            blank_i,  // the pixel sets no bit, or there is none
    input  logic            fresh_i,  // the pixel is a word's first
    input  logic            begin_i,  // the pixel goes to bit 0
    output logic [Bits-1:0] word_o
);
  logic moves_q, blank_q, blank_q2, fresh_q, fresh_q2, begin_q;
  logic [Bits-1:0] place_q, word_q3;  // place_q: one-hot; 0 if the pixel goes to another slice

  always_ff @(posedge clk_i) begin
    moves_q  <= begin_i || fresh_i || valid_i;
    blank_q  <= blank_i;
    fresh_q  <= fresh_i;
    begin_q  <= begin_i;
    blank_q2 <= blank_q;
    fresh_q2 <= fresh_q;
    if (moves_q) place_q <= begin_q ? Bits'(1) : fresh_q ? '0 : place_q << 1;
    word_q3 <= (fresh_q2 ? '0 : word_q3) | (blank_q2 ? '0 : place_q);
  end
  assign word_o = word_q3;
endmodule : slog_packer_slice
