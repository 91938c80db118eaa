// A few bits of slog_packer's word, with registers of their own for the pixel and what clears them.
//
//   stage  registers
//   1      where the pixel sets a bit
//   2      word_o
// Throughput : one pixel per clock.
module slog_packer_slice #(
    parameter int unsigned Bits  = 16,
    parameter bit          First = 1'b0  // bit 0 is the word's
) (
    input  logic            clk_i,
    input  logic            blank_i,  // the pixel sets no bit
    input  logic            fresh_i,  // the pixel is a word's first
    input  logic [Bits-1:0] place_i,  // one-hot or 0: where it goes, if it is not
    output logic [Bits-1:0] word_o
);
  logic fresh_q;
  logic [Bits-1:0] set_q, word_q2;

  always_ff @(posedge clk_i) begin
    fresh_q <= fresh_i;
    set_q   <= blank_i ? '0 : fresh_i ? Bits'(First) : place_i;
    word_q2 <= fresh_q ? set_q : word_q2 | set_q;
  end
  assign word_o = word_q2;
endmodule : slog_packer_slice
