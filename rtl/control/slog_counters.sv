// SPDX-License-Identifier: Apache-2.0
// Event counters of the board, 32 bits each, modulo 2**32, zero after reset.
//
// Formats    : Bits is 32 on the board; with fewer a test can make the counters wrap.
// Latency    : count_o includes an event two clocks after it.
// Throughput : one event of each kind per clock.
// Reset      : rst_i is held for 1 clock or more.
module slog_counters #(
    parameter int unsigned Events = 10,
    parameter int unsigned Bits   = 32
) (
    input  logic                        clk_i,
    input  logic                        rst_i,
    input  logic [Events-1:0]           event_i,
    output logic [Events-1:0][Bits-1:0] count_o
);
  for (genvar k = 0; k < Events; k++) begin : g_counter
    logic event_q;
    logic [Bits-1:0] count_q;
    always_ff @(posedge clk_i) begin
      if (rst_i) begin
        event_q <= 1'b0;
        count_q <= '0;
      end else begin
        event_q <= event_i[k];
        if (event_q) count_q <= count_q + 1'b1;
      end
    end
    assign count_o[k] = count_q;
  end
endmodule : slog_counters
