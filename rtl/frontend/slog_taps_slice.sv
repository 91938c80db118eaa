// SPDX-License-Identifier: Apache-2.0
// A few places of one window of slog_taps, on both sides of its centre, with their own registers for loading them.
//
//   newer_o[k]   place centre + Begin + k            older_o[k]   place centre - Begin - 1 - k
//
// Begin = Places * the slice's number. In most clocks every value moves on by one place: newer_i enters the newer places,
// older_i the older ones. When a line enters the centre, the newer places are loaded with the line's next values from the
// shift register next_q, and the older ones with its first value, which was captured as it passed through next_q.
//
// Latency    : enter_i to the loaded places 4 clocks.
// Throughput : one value per clock.
// Formats    : opaque values of DataW bits, in fields of 32 bits: machine words, which simulate fast.
`include "slog_assert.svh"
module slog_taps_slice #(
    parameter int unsigned Places = 4,
    parameter int unsigned DataW  = 18
) (
    input  logic                    clk_i,
    input  logic                    enter_i,
    input  logic                    first_i,  // next_i is a line's first value
    input  logic [DataW-1:0]        next_i,
    input  logic [DataW-1:0]        newer_i,
    input  logic [DataW-1:0]        older_i,
    output logic [DataW-1:0]        next_o,   // next_i from Places clocks ago
    output logic [Places-1:0][31:0] newer_o,
    output logic [Places-1:0][31:0] older_o
);
  logic enter_q, enter_q2, enter_q3;
  logic [2:0] caught_q;  // [k]: next_q[Places-1-k] is a line's first value
  logic [Places-1:0][31:0] next_q, newer_q, older_q;
  logic [31:0] first_q;

  always_ff @(posedge clk_i) begin
    enter_q  <= enter_i;
    enter_q2 <= enter_q;
    enter_q3 <= enter_q2;
    next_q   <= {32'(next_i), next_q[Places-1:1]};
    caught_q <= {caught_q[1:0], first_i};
    if (caught_q[2]) first_q <= next_q[Places-3];
    if (enter_q3) begin
      newer_q <= next_q;
      older_q <= {Places{first_q}};
    end else begin
      newer_q <= {32'(newer_i), newer_q[Places-1:1]};
      older_q <= {older_q[Places-2:0], 32'(older_i)};
    end
  end

  assign next_o  = next_q[0][DataW-1:0];
  assign newer_o = newer_q;
  assign older_o = older_q;

  `SLOG_ASSERT_INIT(SlogTapsSlicePlaces, Places > 2)
endmodule : slog_taps_slice
