// SPDX-License-Identifier: Apache-2.0
// A few bits of the cameras' word queues before the store, with its own pointers and flags: no net spans all bits.
//
// slog_capture_channel counts the queues' levels. A word leaves in every clock in which one is held; camera 0 has priority.
//
//   stage  registers
//   1      push, word, empty flags
//   2      queue, of Depth words; data_o
// Latency    : 3 clocks from push_i to data_o when the queues are empty: empty_i falls in the clock after push_i.
// Throughput : one word per camera and clock in, one word per clock out.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_capture_slice #(
    parameter  int unsigned Cameras = 2,
    parameter  int unsigned Width   = 16,
    parameter  int unsigned Depth   = 4,
    localparam int unsigned PlaceW  = $clog2(Depth)
) (
    input  logic                          clk_i,
    input  logic                          rst_i,
    input  logic [Cameras-1:0]            push_i,
    input  logic [Cameras-1:0][Width-1:0] data_i,
    input  logic [Cameras-1:0]            empty_i,  // the camera's queue holds no word
    output logic [Width-1:0]              data_o
);
  logic [Cameras-1:0] push_q, empty_q, pop;
  logic [Cameras-1:0][Width-1:0] front;
  logic [Width-1:0] data_q;

  always_ff @(posedge clk_i) begin
    push_q  <= rst_i ? '0 : push_i;
    empty_q <= rst_i ? '1 : empty_i;
  end

  for (genvar c = 0; c < Cameras; c++) begin : g_queue
    logic [Width-1:0] mem_q[Depth];
    logic [Width-1:0] word_q;
    logic [PlaceW-1:0] head_q, tail_q;
    assign front[c] = mem_q[head_q];
    // Camera 0 never waits for the other.
    assign pop[c] = !empty_q[c] && (c == 0 || empty_q[0]);
    always_ff @(posedge clk_i) begin
      word_q <= data_i[c];
      if (push_q[c]) mem_q[tail_q] <= word_q;
    end
    always_ff @(posedge clk_i) begin
      if (rst_i) begin
        head_q <= '0;
        tail_q <= '0;
      end else begin
        if (push_q[c]) tail_q <= tail_q + 1'b1;
        if (pop[c]) head_q <= head_q + 1'b1;
      end
    end
  end

  always_ff @(posedge clk_i) begin
    data_q <= empty_q[0] ? front[Cameras-1] : front[0];
  end
  assign data_o = data_q;

  `SLOG_ASSERT_INIT(SlogCaptureSliceDepth, Depth == 2 ** PlaceW)
  `SLOG_ASSERT_INIT(SlogCaptureSliceCameras, Cameras <= 2)
endmodule : slog_capture_slice
