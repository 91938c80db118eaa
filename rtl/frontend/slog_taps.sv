// SPDX-License-Identifier: Apache-2.0
// Windows of the two horizontal filters: the 2 * Radius + 1 values around each value of a line. Past the line's ends its
// first and last value are repeated. Two values per pixel, each with its own window.
//
// window[i] = value at x - Radius + i, or the nearest value of the line; x: column of the pixel in the centre
//
// A window moves by one place per clock. When a line's first value reaches the centre, the window is loaded: older places
// with that value, newer ones from a shift register of the line's next values. After the last value has entered, the
// newest place keeps it.
//
// Latency    : Radius + 2 clocks from valid_i to valid_o with that pixel in the centre.
// Throughput : one pixel per clock. A line's pixels enter in consecutive clocks, at least 2 * Radius + 2 of them;
//              between lines any pause is allowed.
// Formats    : opaque values of DataW <= 32 bits, in the windows zero-extended to 32 bits; without valid_o a window is
//              undefined.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_taps #(
    parameter  int unsigned Radius  = 8,
    parameter  int unsigned DataW   = 18,
    localparam int unsigned Taps    = 2 * Radius + 1,
    localparam int unsigned Latency = Radius + 2
) (
    input  logic                  clk_i,
    input  logic                  rst_i,
    input  logic                  valid_i,
    input  logic                  first_i,     // first pixel of a line, with valid_i
    input  logic                  last_i,      // last, with valid_i
    input  logic [DataW-1:0]      a_i,
    input  logic [DataW-1:0]      b_i,
    output logic                  valid_o,     // the centre is a pixel
    output logic [Taps-1:0][31:0] a_window_o,  // [0] is the oldest
    output logic [Taps-1:0][31:0] b_window_o
);
  logic [Latency-1:0] valid_q;  // [k]: the value from k + 1 clocks ago is a pixel
  always_ff @(posedge clk_i) begin
    if (rst_i) valid_q <= '0;
    else valid_q <= {valid_q[Latency-2:0], valid_i};
  end
  assign valid_o = valid_q[Latency-1];

  slog_taps_window #(
      .Radius(Radius),
      .DataW (DataW)
  ) u_a (
      .clk_i,
      .rst_i,
      .first_i,
      .last_i,
      .data_i  (a_i),
      .window_o(a_window_o)
  );

  slog_taps_window #(
      .Radius(Radius),
      .DataW (DataW)
  ) u_b (
      .clk_i,
      .rst_i,
      .first_i,
      .last_i,
      .data_i  (b_i),
      .window_o(b_window_o)
  );

  `SLOG_ASSERT_INIT(SlogTapsWidth, DataW <= 32)
  `SLOG_ASSERT_NEXT(SlogTapsConsecutive, valid_i && !last_i, valid_i)
  `SLOG_ASSERT(SlogTapsEnds, !(first_i || last_i) || valid_i)
endmodule : slog_taps
