// SPDX-License-Identifier: Apache-2.0
// Left-right check of the dense engine: lays the right plane's own winners beside those of the left plane.
//
//   agrees = found && |back - index| <= 1       back: best offset of the right pixel that offset index leads to
//
// The back word of the right pixel that offset k leads to leaves the engine Offsets - k clocks after the left pixel's winner.
// So all that is needed are two circular memories with one place for each clock: the winners are held until every such word
// has come, and the back words are then looked up by their time. Neither rows nor columns matter.
//
// Stage  registers                              clocks after winner_i
//   0    winners' memory, written               0
//   1    the same, read at Offsets              Offsets + 2
//   2    back_at_q: place of the back word      Offsets + 3
//   3    back words' memory                     Offsets + 5
//   4    difference_q                           Offsets + 6
//   5    near_q                                 Offsets + 7
//   6    checked_o, valid_o                     Offsets + 8
// Latency    : Offsets + 8 clocks.
// Throughput : one winner and one back word per clock, with or without valids.
// Formats    : found: an offset counts at the pixel.
// Reset      : rst_i is held for 1 clock or more. valid_o is undefined for Offsets + 8 clocks after it.
`include "slog_assert.svh"
module slog_dense_check
  import slog_dense_pkg::*;
#(
    parameter int unsigned Offsets = 128
) (
    input  logic                     clk_i,
    input  logic                     rst_i,
    input  logic                     winner_valid_i,
    // What only the lanes need of a winner, and the right plane's sums, end here.
    /* verilator lint_off UNUSEDSIGNAL */
    input  winner_t                  winner_i,
    input  back_t                    back_i,
    /* verilator lint_on UNUSEDSIGNAL */
    output logic                     valid_o,
    output checked_t                 checked_o
);
  localparam int unsigned AddrW  = $clog2(Offsets + 4);
  localparam int unsigned Places = 2 ** AddrW;
  localparam int unsigned Last   = 4;  // held_q's stage beside near_q
  localparam int unsigned Half   = SumBits / 2;

  typedef logic [AddrW-1:0] at_t;
  typedef struct packed {
    logic                 valid;
    logic [IndexBits-1:0] index;
    sum_t                 best;
    sum_t                 lower;
    sum_t                 upper;
    sum_t                 rest;
  } held_t;

  // Places of this clock, of Offsets clocks ago, and of the clock from which a winner's back word is counted.
  at_t now_q, then_q, from_q, back_at_q;
  held_t come, held;
  held_t held_q[Last+1];
  logic [IndexBits-1:0] back;
  logic signed [IndexBits:0] difference_q;
  checked_t checked_q;
  logic valid_q;

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      now_q  <= '0;
      then_q <= at_t'(Places - Offsets);
      from_q <= at_t'(Places - 2);
    end else begin
      now_q  <= now_q + 1'b1;
      then_q <= then_q + 1'b1;
      from_q <= from_q + 1'b1;
    end
  end

  assign come = '{valid: winner_valid_i, index: winner_i.index, best: winner_i.best, lower: winner_i.lower,
                  upper: winner_i.upper, rest: winner_i.rest};
  slog_ram #(
      .Width($bits(held_t)),
      .Depth(Places)
  ) u_winners (
      .clk_i,
      .wr_en_i  (1'b1),
      .wr_addr_i(now_q),
      .wr_data_i(come),
      .rd_en_i  (1'b1),
      .rd_addr_i(then_q),
      .rd_data_o(held)
  );
  slog_ram #(
      .Width(IndexBits),
      .Depth(Places)
  ) u_backs (
      .clk_i,
      .wr_en_i  (1'b1),
      .wr_addr_i(now_q),
      .wr_data_i(back_i.index),
      .rd_en_i  (1'b1),
      .rd_addr_i(back_at_q),
      .rd_data_o(back)
  );

  logic low_q, high_q, found_q, near_q;  // found_q: the best sum is not Absent, by one half or the other
  always_ff @(posedge clk_i) begin
    back_at_q <= from_q - at_t'(held.index);
    held_q[0] <= held;
    for (int unsigned n = 1; n <= Last; n++) held_q[n] <= held_q[n-1];
    difference_q <= {1'b0, back} - {1'b0, held_q[2].index};
    near_q       <= difference_q == '0 || difference_q == '1 || difference_q == (IndexBits + 1)'(1);
    low_q        <= held_q[Last-2].best[Half-1:0] != Absent[Half-1:0];
    high_q       <= held_q[Last-2].best[SumBits-1:Half] != Absent[SumBits-1:Half];
    found_q      <= low_q || high_q;
    valid_q      <= held_q[Last].valid;
    checked_q    <= '{found: found_q, agrees: found_q && near_q, index: held_q[Last].index, best: held_q[Last].best,
                      lower: held_q[Last].lower, upper: held_q[Last].upper, rest: held_q[Last].rest};
  end
  assign valid_o   = valid_q;
  assign checked_o = checked_q;

  `SLOG_ASSERT_INIT(SlogDenseCheckOffsets, Offsets >= 2 && Offsets <= 2 ** IndexBits)
endmodule : slog_dense_check
