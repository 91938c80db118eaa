// SPDX-License-Identifier: Apache-2.0
// One window of slog_taps, cut into slices: the two places that are folded together and share a multiplier are in one slice.
//
// Latency, throughput, formats: those of slog_taps.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_taps_window #(
    parameter  int unsigned Radius = 8,
    parameter  int unsigned DataW  = 18,
    localparam int unsigned Taps   = 2 * Radius + 1
) (
    input  logic                  clk_i,
    input  logic                  rst_i,
    input  logic                  first_i,
    input  logic                  last_i,
    input  logic [DataW-1:0]      data_i,
    output logic [Taps-1:0][31:0] window_o
);
  localparam int unsigned Places = 4;
  localparam int unsigned Slices = Radius / Places;

  // The slices lie far apart: data_q delays the values by a clock, in which the load signals reach the slices.
  logic [Radius-1:0] first_q;          // [k]: the value from k + 1 clocks ago is a line's first
  logic              last_q;           // the value from the clock before is a line's last
  logic              past_q2;          // the newest place keeps a line's last value in this clock
  logic [DataW-1:0]  data_q, newest_q;

  always_ff @(posedge clk_i) begin
    data_q <= data_i;
    if (!past_q2) newest_q <= data_q;
    if (rst_i) begin
      first_q <= '0;
      last_q  <= 1'b0;
      past_q2 <= 1'b0;
    end else begin
      first_q <= {first_q[Radius-2:0], first_i};
      last_q  <= last_i;
      past_q2 <= last_q || (past_q2 && !first_q[Radius-1]);
    end
  end

  for (genvar s = 0; s < Slices; s++) begin : g_slice
    logic [DataW-1:0] next, newer, older, next_out;
    logic [Places-1:0][31:0] newer_out, older_out;
    if (s == Slices - 1) begin : g_newest
      assign next  = data_q;
      assign newer = newest_q;
    end else begin : g_newer
      assign next  = g_slice[s+1].next_out;
      assign newer = g_slice[s+1].newer_out[0][DataW-1:0];
    end
    if (s == 0) begin : g_centre
      assign older = newer_out[0][DataW-1:0];
    end else begin : g_older
      assign older = g_slice[s-1].older_out[Places-1][DataW-1:0];
    end

    slog_taps_slice #(
        .Places(Places),
        .DataW (DataW)
    ) u_slice (
        .clk_i,
        .enter_i(first_q[Radius-3]),
        .first_i(first_q[Radius-Places*(s+1)]),
        .next_i (next),
        .newer_i(newer),
        .older_i(older),
        .next_o (next_out),
        .newer_o(newer_out),
        .older_o(older_out)
    );
    assign window_o[Radius+Places*s+:Places] = newer_out;
    for (genvar k = 0; k < Places; k++) begin : g_place
      assign window_o[Radius-Places*s-1-k] = older_out[k];
    end
  end
  assign window_o[Taps-1] = 32'(newest_q);

  `SLOG_ASSERT_INIT(SlogTapsWindowRadius, Radius >= 2 * Places && Radius % Places == 0)
endmodule : slog_taps_window
