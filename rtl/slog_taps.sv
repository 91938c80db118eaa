// Border control of the two horizontal filters: which of a line's values lie past its border, and what replaces them.
//
// A filter's window is its last 2 * Radius + 1 values, one more a clock; new_o is the newest. While the output pixel is
// in the centre, edge_o is the line's first or last value, whichever border is near, and beyond_old_o / beyond_new_o say
// which values lie past it (bit d - 1: distance d to the left / right). Two values per pixel, with the same border.
//
// Stages     : 1 newest value    then Radius clocks until it is in the centre
// Latency    : 1 clock from valid_i to new_o, Radius + 1 clocks to valid_o with that pixel in the centre.
// Throughput : one pixel per clock. A line's pixels come in consecutive clocks, at least 2 * Radius + 2 of them;
//              between lines any pause is allowed.
// Formats    : opaque values of DataW bits.
`include "slog_assert.svh"
module slog_taps #(
    parameter  int unsigned Radius  = 8,
    parameter  int unsigned DataW   = 17,
    localparam int unsigned Latency = Radius + 1
) (
    input  logic              clk_i,
    input  logic              rst_i,
    input  logic              valid_i,
    input  logic              first_i,       // first pixel of a line
    input  logic              last_i,
    input  logic [DataW-1:0]  a_i,
    input  logic [DataW-1:0]  b_i,
    output logic [DataW-1:0]  a_new_o,
    output logic [DataW-1:0]  b_new_o,
    output logic              valid_o,       // the centre is a pixel
    output logic [DataW-1:0]  a_edge_o,
    output logic [DataW-1:0]  b_edge_o,
    output logic [Radius-1:0] beyond_old_o,
    output logic [Radius-1:0] beyond_new_o
);
  logic [Latency-1:0] valid_q;  // [k]: value k of the shift register is a pixel
  logic [Radius-1:0]  first_q;  // [k]: it is a line's first
  logic               last_q;   // value 0 is a line's last
  logic [Radius-1:0]  old_q, new_q;

  // The left border passes from the centre on, the right one up to the centre.
  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      valid_q <= '0;
      first_q <= '0;
      last_q  <= 1'b0;
      old_q   <= '0;
      new_q   <= '0;
    end else begin
      valid_q <= {valid_q[Latency-2:0], valid_i};
      first_q <= {first_q[Radius-2:0], valid_i && first_i};
      last_q  <= valid_i && last_i;
      old_q   <= first_q[Radius-1] ? '1 : old_q << 1;
      if (last_q) new_q <= {1'b1, {(Radius - 1) {1'b0}}};
      else new_q <= new_q[0] ? '0 : {new_q[Radius-1], new_q[Radius-1:1]};  // it fills up from the top
    end
  end

  logic [DataW-1:0] a_q, a_first_q, a_edge_q, b_q, b_first_q, b_edge_q;
  always_ff @(posedge clk_i) begin
    a_q <= a_i;
    b_q <= b_i;
    if (valid_i && first_i) begin
      a_first_q <= a_i;
      b_first_q <= b_i;
    end
    if (first_q[Radius-1]) begin
      a_edge_q <= a_first_q;
      b_edge_q <= b_first_q;
    end else if (last_q) begin
      a_edge_q <= a_q;
      b_edge_q <= b_q;
    end
  end

  assign a_new_o      = a_q;
  assign b_new_o      = b_q;
  assign a_edge_o     = a_edge_q;
  assign b_edge_o     = b_edge_q;
  assign valid_o      = valid_q[Latency-1];
  assign beyond_old_o = old_q;
  assign beyond_new_o = new_q;

  `SLOG_ASSERT_INIT(SlogTapsRadius, Radius >= 2)
endmodule : slog_taps
