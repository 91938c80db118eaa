// SPDX-License-Identifier: Apache-2.0
// Follows the captures of a live pass: whether the rows are in the store that its next row needs, and what becomes of its frames.
//
//   there_o = the left frame has row y, and y - down < 0 or the right frame has row y - down
//
// A frame has row n if it is whole, or if n < progress_i.rows of the camera that writes it; the rows above n are there, too. y is
// the number of row_i since begin_i. At begin_i each plane of the job is in one of these states; later it only goes on:
//
//   awaited    a request for its slot waits for a frame, or its frame has begun and nothing is written yet
//   followed   the frame is being written
//   whole      the slot holds a frame that nobody writes; or that of the plane's request has become whole
//   lost       the request is gone before its frame was whole, or the frame was aborted, or the image's size has changed
//   (absent)   neither a frame nor a request, or the image's size changes in this clock: the job is refused
//
//   stage  registers
//   1      progress_i, slot_valid_i, clear_i; the slot of each camera's request, one-hot like the job's
//   2      states, here_o and keep_o; rows of the plane's frame
//   3      has the frame its row
//   4      there_o, whole_o, lost_o
// Latency    : progress_i to there_o 4 clocks, to keep_o 2; row_i to there_o of the next row 3; begin_i to here_o 1, to there_o
//              3.
// Throughput : rows 4 clocks apart or more, and the first as long after begin_i: there_o of a row comes before it.
// Rules      : begin_i with or after the job, which is constant while reading_i is high: from begin_i on, until no word is
//              read any more. Between passes reading_i is low for 3 clocks or more. row_i only with there_o of that row in
//              the clock before. While a camera is writing, the rows it has written do not become fewer.
// Formats    : slots_i, here_o and keep_o: [0] left, [1] right plane. A slot is one-hot; none: the plane is absent. keep_o:
//              no capture may begin to write the plane's slot; low while it is awaited. Where live_i is low: there_o and
//              whole_o high, lost_o low, keep_o high.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_dense_live
  import slog_store_pkg::*;
  import slog_compare_pkg::*;
#(
    parameter int unsigned Cameras = 2,
    parameter int unsigned Slots   = 8
) (
    input  logic                          clk_i,
    input  logic                          rst_i,
    input  logic                          begin_i,
    input  logic                          reading_i,
    input  logic                          live_i,
    input  logic         [1:0][Slots-1:0] slots_i,
    input  logic signed             [9:0] down_i,
    input  logic                          row_i,
    input  progress_t [Cameras-1:0]       progress_i,
    input  logic              [Slots-1:0] slot_valid_i,
    input  logic                          clear_i,       // pulse: the image's size has changed
    output logic                    [1:0] here_o,        // the plane is not absent
    output logic                    [1:0] keep_o,
    output logic                          there_o,
    output logic                          whole_o,       // both planes
    output logic                          lost_o         // a plane
);
  // Stage 1: captures and registers are far away.
  /* verilator lint_off UNUSEDSIGNAL */
  progress_t [Cameras-1:0] come_q;      // its request's slot is in asks_q
  /* verilator lint_on UNUSEDSIGNAL */
  logic [Cameras-1:0][Slots-1:0] asks_q; // the slot for which the camera has a request
  logic [Slots-1:0] slot_valid_q;
  logic clear_q;
  always_ff @(posedge clk_i) begin
    come_q       <= progress_i;
    slot_valid_q <= slot_valid_i;
    clear_q      <= clear_i;
    for (int unsigned c = 0; c < Cameras; c++) begin
      for (int unsigned s = 0; s < Slots; s++) asks_q[c][s] <= progress_i[c].held && progress_i[c].slot == 3'(s);
    end
  end

  // Stage 2.
  logic [1:0] asked, writes, done;      // of the camera with a request for the plane's slot
  logic [1:0] holds;                    // the slot holds a frame
  logic [1:0] waits;
  logic [1:0] awaited_q, followed_q, whole_q, lost_q, here_q;
  logic [1:0][9:0] rows, rows_q;
  always_comb begin
    asked  = '0;
    writes = '0;
    done   = '0;
    rows   = '0;
    for (int unsigned p = 0; p < 2; p++) begin
      holds[p] = (slots_i[p] & slot_valid_q) != '0;
      for (int unsigned c = 0; c < Cameras; c++) begin
        if ((slots_i[p] & asks_q[c]) != '0) begin
          asked[p]  = 1'b1;
          writes[p] |= come_q[c].writing;
          done[p]   |= come_q[c].done;
          rows[p]   |= come_q[c].rows;
        end
      end
    end
  end
  assign waits = awaited_q | followed_q;
  // Without a pass, or a live one, nobody looks at awaited_q.
  always_ff @(posedge clk_i) begin
    rows_q    <= rows;
    awaited_q <= {2{!clear_q}} & asked & ~writes & (awaited_q | {2{begin_i}});
    if (rst_i || !reading_i || !live_i) begin
      followed_q <= '0;
      whole_q    <= '0;
      lost_q     <= '0;
      here_q     <= '0;
    end else if (begin_i) begin
      followed_q <= {2{!clear_q}} & asked & writes & ~done;
      whole_q    <= {2{!clear_q}} & (done | (~asked & holds));
      lost_q     <= '0;
      here_q     <= {2{!clear_q}} & (asked | holds);
    end else begin
      followed_q <= waits & {2{!clear_q}} & asked & writes & ~done;
      whole_q    <= whole_q | (waits & done);
      lost_q     <= lost_q | (waits & ~done & ({2{clear_q}} | ~asked | (followed_q & ~writes)));
    end
  end

  // Rows that come next: of the left plane, and of the right one, negative above it.
  logic [9:0] y_q;
  logic signed [11:0] r_q;
  always_ff @(posedge clk_i) begin
    if (begin_i) begin
      y_q <= '0;
      r_q <= -12'(down_i);
    end else if (row_i) begin
      y_q <= y_q + 1'b1;
      r_q <= r_q + 1'b1;
    end
  end

  // Stages 3 and 4.
  logic [1:0] has_q;
  logic there_q, both_q, any_lost_q;
  always_ff @(posedge clk_i) begin
    has_q[0]   <= whole_q[0] || (followed_q[0] && is_above(32'(rows_q[0]), 32'(y_q)));
    has_q[1]   <= whole_q[1] || r_q[11] || (followed_q[1] && is_above(32'(rows_q[1]), 32'(r_q[10:0])));
    there_q    <= has_q == '1 || !live_i;
    both_q     <= whole_q == '1 || !live_i;
    any_lost_q <= lost_q != '0 && !rst_i;
  end

  assign here_o  = here_q;
  assign keep_o  = {2{!live_i}} | followed_q | whole_q | lost_q;
  assign there_o = there_q;
  assign whole_o = both_q;
  assign lost_o  = any_lost_q;

  `SLOG_ASSERT_INIT(SlogDenseLiveSizes, Cameras <= 2 && Slots <= 8)
  for (genvar p = 0; p < 2; p++) begin : g_plane
    `SLOG_ASSERT(SlogDenseLiveSlot, !reading_i || $onehot0(slots_i[p]))
    `SLOG_ASSERT(SlogDenseLiveState, $onehot0({awaited_q[p], followed_q[p], whole_q[p], lost_q[p]}))
    `SLOG_ASSERT(SlogDenseLiveRows, !(followed_q[p] && writes[p]) || rows[p] >= rows_q[p])
  end
  `SLOG_PAST(past_there, there_q)
  `SLOG_ASSERT(SlogDenseLiveThere, !(row_i && reading_i) || past_there)
`ifndef SYNTHESIS
  logic [2:0] near_q;  // a row, or begin_i, in each of the three clocks before
  logic [1:0] low_q;   // clocks for which reading_i has been low, up to 3; a reset is one of them
  always_ff @(posedge clk_i) begin
    near_q <= rst_i ? '0 : {near_q[1:0], begin_i || row_i};
    low_q  <= rst_i ? 2'd1 : reading_i ? '0 : low_q + 2'(low_q != '1);
  end
`endif
  `SLOG_ASSERT(SlogDenseLiveApart, !row_i || near_q == '0)
  `SLOG_ASSERT(SlogDenseLivePause, begin_i ? reading_i && low_q == '1 : !reading_i || low_q == '0)
  `SLOG_ASSERT_KEPT(SlogDenseLiveJob, reading_i, {live_i, slots_i, down_i})
endmodule : slog_dense_live
