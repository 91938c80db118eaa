// SPDX-License-Identifier: Apache-2.0
// Checks the signs of one frame against those of the golden model, without Python: the test of a front end in a design of
// one's own, and the simulation of signum.core. It also shows how slog_frontend is driven.
//
// frame.hex: pixels, 8 bits, in raster order. signs.hex: words of the sign plane in raster order, bit 0 the leftmost.
// Both were made with sigma = Quarters / 4 by sim/testbench/vectors.py. Ends with PASS, or with an error.
module tb_signs #(
    parameter int unsigned Width     = 48,
    parameter int unsigned Height    = 36,
    parameter int unsigned Quarters  = 6,
    parameter int unsigned GroupBits = 8
);
  `include "slog_coefs.svh"
  localparam int unsigned Radius = 8;
  localparam int unsigned Words  = Width / GroupBits * Height;

  logic [7:0]           frame[Width*Height];
  logic [GroupBits-1:0] signs[Words];
  initial begin
    $readmemh("frame.hex", frame);
    $readmemh("signs.hex", signs);
  end

  logic clk, rst;
  initial begin
    clk = 1'b0;
    forever #5 clk = !clk;
  end
  initial begin
    rst = 1'b1;
    #100 rst = 1'b0;
  end

  // Some clocks after reset, a pixel in every clock in which the front end is ready.
  int unsigned clocks, sent, received;
  logic        valid, ready;
  assign valid = clocks >= 40 && sent < Width * Height;

  logic                 word_valid, frame_done, frame_abort, dropped;
  logic                 unused_busy, unused_last, unused_start, unused_accepted;
  logic [GroupBits-1:0] word_data;

  slog_frontend #(
      .MaxWidth (Width),
      .Radius   (Radius),
      .GroupBits(GroupBits)
  ) u_dut (
      .clk_i        (clk),
      .rst_i        (rst),
      .tdata_i      (frame[valid ? sent : 0]),
      .tvalid_i     (valid),
      .tready_o     (ready),
      .tuser_i      (sent == 0),
      .tlast_i      (sent % Width == Width - 1),
      .width_i      (10'(Width)),
      .height_i     (10'(Height)),
      .g_i          (slog_g_radius8(Quarters)),
      .g2_i         (slog_g2_radius8(Quarters)),
      .hold_i       (1'b0),
      .abort_i      (1'b0),
      .busy_o       (unused_busy),
      .word_valid_o (word_valid),
      .word_data_o  (word_data),
      .word_last_o  (unused_last),
      .frame_start_o(unused_start),
      .frame_done_o (frame_done),
      .frame_abort_o(frame_abort),
      .accepted_o   (unused_accepted),
      .dropped_o    (dropped)
  );

  always_ff @(posedge clk) begin
    if (rst) begin
      clocks   <= 0;
      sent     <= 0;
      received <= 0;
    end else begin
      clocks <= clocks + 1;
      if (valid && ready) sent <= sent + 1;
      if (word_valid) begin
        received <= received + 1;
        if (word_data != signs[received]) $fatal(1, "word %0d is %h, not %h", received, word_data, signs[received]);
      end
      if (frame_abort || dropped) $fatal(1, "the frame was dropped");
      if (frame_done) begin
        if (received + 1 != Words) $fatal(1, "%0d words, not %0d", received + 1, Words);
        $display("PASS: %0d words of signs are those of the golden model", Words);
        $finish;
      end
      if (clocks == 20_000) $fatal(1, "no frame after %0d clocks", clocks);
    end
  end
endmodule : tb_signs
