// Horizontal window over lines of two values per pixel, with the value of the near border at hand.
//
// window_o[v][Radius] is the output pixel's value, window_o[v][Radius + d] lies d pixels to its left,
// window_o[v][Radius - d] to its right. edge_o is the line's first or last value, whichever border is near; beyond_old_o
// and beyond_new_o say which values lie past it (bit d - 1: distance d to the left / right), to be replaced by it.
//
// Stages     : Radius + 1 shifts until the pixel is in the centre, then edge: one of eight, edge: one of the eights
// Latency    : Radius + 3 clocks from valid_i to window_o with that pixel in the centre.
// Throughput : one pixel per clock. A line's pixels come in consecutive clocks, at least 2 * Radius + 2 of them;
//              between lines any pause is allowed.
`include "slog_assert.svh"
module slog_taps #(
    parameter  int unsigned Radius  = 8,
    parameter  int unsigned DataW   = 17,
    localparam int unsigned Taps    = 2 * Radius + 1,
    localparam int unsigned Latency = Radius + 3
) (
    input  logic              clk_i,
    input  logic              rst_i,
    input  logic              valid_i,
    input  logic              first_i,          // first pixel of a line
    input  logic              last_i,
    input  logic [DataW-1:0]  data_i[2],
    output logic              valid_o,
    output logic [DataW-1:0]  window_o[2][Taps],
    output logic [DataW-1:0]  edge_o[2],
    output logic [Radius-1:0] beyond_old_o,
    output logic [Radius-1:0] beyond_new_o
);
  localparam int unsigned Depth  = Taps + 2;  // the window waits two clocks for its edge
  localparam int unsigned Centre = Radius;    // where the edge is looked up
  localparam int unsigned Eights = Radius / 4;
  localparam int unsigned PosW   = $clog2(2 * Radius);

  logic [Latency-1:0] valid_q;  // [k]: value k of the shift register is a pixel
  logic [Centre-1:0]  first_q;
  logic               last_q;
  logic [PosW-1:0]    pos_q;
  logic [PosW-4:0]    eight_q2;
  logic [Radius-1:0]  old_q, old_q2, old_q3, new_q, new_q2, new_q3;
  logic               move;

  assign move = valid_i || valid_q != '0;

  always_ff @(posedge clk_i) begin
    if (rst_i) valid_q <= '0;
    else valid_q <= {valid_q[Latency-2:0], valid_i};
  end

  // The border value passes through the window, the first one from the centre on, the last one up to the centre; its
  // place is numbered from the value before the newest.
  always_ff @(posedge clk_i) begin
    if (move) begin
      first_q <= {first_q[Centre-2:0], valid_i && first_i};
      last_q  <= valid_i && last_i;
      if (first_q[Centre-1]) begin
        pos_q <= PosW'(Radius - 1);
        old_q <= '1;
        new_q <= '0;
      end else if (last_q) begin
        pos_q <= '0;
        old_q <= '0;
        new_q <= {1'b1, {(Radius - 1) {1'b0}}};
      end else begin
        pos_q <= pos_q + 1'b1;
        old_q <= old_q << 1;
        new_q <= (new_q == '1) ? '0 : {new_q[Radius-1], new_q[Radius-1:1]};
      end
      eight_q2 <= pos_q[PosW-1:3];
      old_q2 <= old_q;
      new_q2 <= new_q;
      old_q3 <= old_q2;
      new_q3 <= new_q2;
    end
  end

  for (genvar v = 0; v < 2; v++) begin : g_value
    logic [DataW-1:0] shift_q[Depth];
    logic [DataW-1:0] edge_q2[Eights];
    logic [DataW-1:0] edge_q3;

    for (genvar i = 0; i < Depth; i++) begin : g_shift
      always_ff @(posedge clk_i) begin
        if (move) shift_q[i] <= (i == 0) ? data_i[v] : shift_q[(i == 0) ? 0 : i - 1];
      end
    end

    for (genvar e = 0; e < Eights; e++) begin : g_edge
      logic [DataW-1:0] eight[8];
      for (genvar i = 0; i < 8; i++) begin : g_candidate
        assign eight[i] = shift_q[8*e+i+1];
      end
      always_ff @(posedge clk_i) begin
        if (move) edge_q2[e] <= eight[pos_q[2:0]];
      end
    end
    always_ff @(posedge clk_i) begin
      if (move) edge_q3 <= edge_q2[eight_q2];
    end

    for (genvar i = 0; i < Taps; i++) begin : g_window
      assign window_o[v][i] = shift_q[i+2];
    end
    assign edge_o[v] = edge_q3;
  end

  assign valid_o      = valid_q[Latency-1];
  assign beyond_old_o = old_q3;
  assign beyond_new_o = new_q3;

  `SLOG_ASSERT_INIT(SlogTapsRadius, Radius >= 8 && (Radius & (Radius - 1)) == 0)
endmodule : slog_taps
