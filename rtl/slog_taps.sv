// Windows of the two horizontal filters: the 2 * Radius + 1 values around each of a line's, continued past its ends
// by its first and last value. Two values per pixel, each with its own window.
//
// window[i] = value x - Radius + i of a line, or else its nearest; x: the pixel in the centre
//
// A window moves by one place a clock. As a line's first value comes into its centre, the window is loaded: older
// places with that value, newer ones from a shift register of the line's next values. When the last value has come,
// its newest place stays as it is.
//
// Latency    : Radius + 1 clocks from valid_i to valid_o with that pixel in the centre.
// Throughput : one pixel per clock. A line's pixels come in consecutive clocks, at least 2 * Radius + 2 of them;
//              between lines any pause is allowed.
// Formats    : opaque values of DataW bits; without valid_o a window is anything.
`include "slog_assert.svh"
module slog_taps #(
    parameter  int unsigned Radius  = 8,
    parameter  int unsigned DataW   = 17,
    localparam int unsigned Taps    = 2 * Radius + 1,
    localparam int unsigned Latency = Radius + 1
) (
    input  logic                       clk_i,
    input  logic                       rst_i,
    input  logic                       valid_i,
    input  logic                       first_i,     // first pixel of a line
    input  logic                       last_i,
    input  logic [DataW-1:0]           a_i,
    input  logic [DataW-1:0]           b_i,
    output logic                       valid_o,     // the centre is a pixel
    output logic [Taps-1:0][DataW-1:0] a_window_o,  // [0] is the oldest
    output logic [Taps-1:0][DataW-1:0] b_window_o
);
  logic [Latency-1:0] valid_q;  // [k]: the value k + 1 clocks old is a pixel
  logic [Radius-1:0]  first_q;  // [k]: it is a line's first
  logic               past_q;   // the newest place keeps a line's last value
  logic               enter;    // a first value comes into the centre

  assign enter = first_q[Radius-1];

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      valid_q <= '0;
      first_q <= '0;
      past_q  <= 1'b0;
    end else begin
      valid_q <= {valid_q[Latency-2:0], valid_i};
      first_q <= {first_q[Radius-2:0], valid_i && first_i};
      past_q  <= (valid_i && last_i) || (past_q && !first_q[Radius-2]);
    end
  end

  logic [DataW-1:0] a_next_q[Radius], b_next_q[Radius];  // [k]: k + 1 clocks old
  logic [DataW-1:0] a_q[Taps], b_q[Taps];
  always_ff @(posedge clk_i) begin
    a_next_q[0] <= a_i;
    b_next_q[0] <= b_i;
    for (int unsigned k = 1; k < Radius; k++) begin
      a_next_q[k] <= a_next_q[k-1];
      b_next_q[k] <= b_next_q[k-1];
    end
    for (int unsigned i = 0; i < Taps - 1; i++) begin
      a_q[i] <= a_q[i+1];
      b_q[i] <= b_q[i+1];
    end
    if (enter) begin
      for (int unsigned i = 0; i < Taps - 1; i++) begin
        a_q[i] <= a_next_q[i < Radius ? Radius - 1 : Taps - 2 - i];
        b_q[i] <= b_next_q[i < Radius ? Radius - 1 : Taps - 2 - i];
      end
    end
    if (!past_q) begin
      a_q[Taps-1] <= a_i;
      b_q[Taps-1] <= b_i;
    end
  end

  assign valid_o = valid_q[Latency-1];
  for (genvar i = 0; i < Taps; i++) begin : g_window
    assign a_window_o[i] = a_q[i];
    assign b_window_o[i] = b_q[i];
  end

  `SLOG_ASSERT_INIT(SlogTapsRadius, Radius >= 2)
endmodule : slog_taps
