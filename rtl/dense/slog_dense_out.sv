// SPDX-License-Identifier: Apache-2.0
// The map's words: every step_x-th column of every step_y-th row, judged, packed, and queued for the sink.
//
//   valid = found && best <= most && (rest == Absent || rest - best >= margin) && (agrees || !check)
//
// Stage  registers
//   1    inputs: valid_q, came_q, and of the map width_q, most_q and their like
//   2    sums compared, column and row counted
//   3    word_q, push_q
//   4..9 slog_ram_fifo, slog_stage: map_tvalid_o with the word
// Latency    : a word is offered 9 clocks after its pixel at the earliest.
// Throughput : one pixel per clock in, one word per clock out.
// Rules      : clear_i before every map, until its pixels come; pixels that come with it are ignored, and none comes with
//              its last clock. Then image_height_i rows of image_width_i pixels, with any
//              pauses, of 2 clocks at least between rows. image_width_i is 2 or more. The image's size, steps, most_i, margin_i
//              and check_i are constant from the last clock of clear_i until the map's last word has been taken. Whoever
//              sends pixels knows that there is room for their words: Depth of them (slog_dense_room). tail_i, when no pixel
//              is due: one word more, the last, in which no offset counts.
// Formats    : a pixel's rest is its best or more. map_t; map_tuser_o with the first word of a map, map_tlast_o with the last.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_dense_out
  import slog_dense_pkg::*;
  import slog_compare_pkg::*;
#(
    parameter int unsigned Depth = 2048
) (
    input  logic           clk_i,
    input  logic           rst_i,
    input  logic           clear_i,
    input  logic           tail_i,
    input  logic           valid_i,
    input  checked_t       pixel_i,
    input  logic     [9:0] image_width_i,
    input  logic     [9:0] image_height_i,
    input  logic     [7:0] step_x_i,
    input  logic     [7:0] step_y_i,
    input  sum_t           most_i,
    input  sum_t           margin_i,
    input  logic           check_i,
    output logic           map_tvalid_o,
    input  logic           map_tready_i,
    output map_t           map_tdata_o,
    output logic           map_tuser_o,
    output logic           map_tlast_o,
    output logic           taken_o          // pulse: the sink took a word two clocks ago
);
  localparam checked_t Nothing = '{found: 1'b0, agrees: 1'b0, index: '0, default: Absent};

  typedef struct packed {
    logic first;
    logic last;
    map_t data;
  } word_t;

  // The wires from slog_dense_pass and slog_dense_check are long: nothing is computed before these.
  logic clear_q, valid_q, tail_in_q, check_q;
  checked_t came_q;
  logic [9:0] width_q, height_q;
  logic [7:0] step_x_q, step_y_q;
  logic [8:0] skip_x_q, skip_y_q;  // a step less two
  sum_t most_q, margin_q;
  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      valid_q   <= 1'b0;
      tail_in_q <= 1'b0;
    end else begin
      valid_q   <= valid_i;
      tail_in_q <= tail_i;
    end
  end
  always_ff @(posedge clk_i) begin
    clear_q  <= clear_i;
    came_q   <= pixel_i;
    width_q  <= image_width_i;
    height_q <= image_height_i;
    step_x_q <= step_x_i;
    step_y_q <= step_y_i;
    skip_x_q <= 9'(step_x_q) - 9'd2;
    skip_y_q <= 9'(step_y_q) - 9'd2;
    most_q   <= most_i;
    margin_q <= margin_i;
    check_q  <= check_i;
  end

  // Place in the image. gap: columns or rows to the next that has a word, less one: negative at it; left: with this one to
  // the end.
  logic [8:0] gap_x_q, gap_y_q;
  logic [9:0] left_x_q, left_y_q;
  logic ends_q;                    // left_x_q == 1
  logic lower_q, beside_q;         // another row with words follows, another column in this row
  logic row_q;                     // a row has ended in the clock before
  logic emit_q, tail_q;
  always_ff @(posedge clk_i) begin
    lower_q <= is_above(32'(left_y_q), 32'(step_y_q));
    row_q   <= valid_q && ends_q;
    if (clear_q) begin
      gap_x_q  <= '1;
      left_x_q <= width_q;
      ends_q   <= 1'b0;
    end else if (valid_q) begin
      gap_x_q  <= ends_q ? '1 : gap_x_q[8] ? skip_x_q : gap_x_q - 1'b1;
      left_x_q <= ends_q ? width_q : left_x_q - 1'b1;
      ends_q   <= left_x_q == 10'd2;
    end
    if (clear_q) begin
      gap_y_q  <= '1;
      left_y_q <= height_q;
    end else if (row_q) begin
      gap_y_q  <= gap_y_q[8] ? skip_y_q : gap_y_q - 1'b1;
      left_y_q <= left_y_q - 1'b1;
    end
  end

  // Stage 2.
  checked_t pixel_q;
  sum_t over_q;
  logic able_q, far_q, alone_q;
  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      emit_q <= 1'b0;
      tail_q <= 1'b0;
    end else begin
      emit_q <= valid_q && !clear_q && gap_x_q[8] && gap_y_q[8];
      tail_q <= tail_in_q;
    end
  end
  always_ff @(posedge clk_i) begin
    beside_q <= is_above(32'(left_x_q), 32'(step_x_q));
    pixel_q  <= tail_in_q ? Nothing : came_q;
    over_q   <= came_q.rest - came_q.best;
    able_q   <= came_q.found && (came_q.agrees || !check_q) && !tail_in_q;
    far_q    <= is_above(32'(came_q.best), 32'(most_q));
    alone_q  <= came_q.rest == Absent;
  end

  // Stage 3.
  word_t word_q;
  logic push_q, begun_q, good;
  assign good = able_q && !far_q && (alone_q || !is_above(32'(margin_q), 32'(over_q)));
  always_ff @(posedge clk_i) begin
    if (rst_i) push_q <= 1'b0;
    else push_q <= emit_q || tail_q;
  end
  always_ff @(posedge clk_i) begin
    if (clear_q) begun_q <= 1'b0;
    else if (emit_q) begun_q <= 1'b1;
    word_q <= '{
        first: !begun_q,
        last: tail_q || !(beside_q || lower_q),
        data: '{zero: '0, valid: good, agrees: pixel_q.agrees, found: pixel_q.found, index: pixel_q.index,
                best: pixel_q.best, lower: pixel_q.lower, upper: pixel_q.upper, rest: pixel_q.rest}
    };
  end

  // The nine zeros are not stored.
  localparam int unsigned StoredW = $bits(word_t) - 9;
  logic [StoredW-1:0] stored, offered, shown;
  logic some, take;
  // The sink lies at the pins, far from where the words are counted. absent_q: !map_tvalid_o, of which the pins are not
  // users: a placer puts the registers after it anywhere between the two.
  logic absent_q, offer_q, ready_q, taken_q2;
  /* verilator lint_off UNUSEDSIGNAL */
  logic room;                              // only asserted: slog_dense_room has seen to it
  logic [$clog2(Depth + 1)-1:0] level;
  /* verilator lint_on UNUSEDSIGNAL */
  assign stored = {word_q.first, word_q.last, word_q.data[$bits(map_t)-10:0]};
  slog_ram_fifo #(
      .Width(StoredW),
      .Depth(Depth),
      .Kept (1'b1)
  ) u_fifo (
      .clk_i,
      .rst_i,
      .in_valid_i (push_q),
      .in_ready_o (room),
      .in_data_i  (stored),
      .out_valid_o(some),
      .out_ready_i(some && take),
      .out_data_o (offered),
      .level_o    (level)
  );
  slog_stage #(
      .Width(StoredW)
  ) u_stage (
      .clk_i,
      .rst_i,
      .in_valid_i (some),
      .in_ready_o (take),
      .in_data_i  (offered),
      .out_valid_o(map_tvalid_o),
      .out_ready_i(map_tready_i),
      .out_data_o (shown)
  );
  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      absent_q <= 1'b1;
      offer_q  <= 1'b0;
      ready_q  <= 1'b0;
      taken_q2 <= 1'b0;
    end else begin
      absent_q <= take && !some;
      offer_q  <= !absent_q;
      ready_q  <= map_tready_i;
      taken_q2 <= offer_q && ready_q;  // the third register on this way is in slog_dense_room
    end
  end
  assign map_tuser_o = shown[StoredW-1];
  assign map_tlast_o = shown[StoredW-2];
  assign map_tdata_o = {9'd0, shown[StoredW-3:0]};
  assign taken_o     = taken_q2;

  `SLOG_ASSERT(SlogDenseOutRoom, !push_q || room)
  `SLOG_ASSERT(SlogDenseOutAbsent, absent_q == !map_tvalid_o)
  `SLOG_ASSERT(SlogDenseOutConstant, clear_i || clear_q || !(valid_q || emit_q) ||
               {image_width_i, image_height_i, step_x_i, step_y_i, most_i, margin_i, check_i} ==
               {width_q, height_q, step_x_q, step_y_q, most_q, margin_q, check_q})
  `SLOG_ASSERT(SlogDenseOutClear, clear_i || !(clear_q && valid_q))
  `SLOG_ASSERT(SlogDenseOutRest, clear_q || !valid_q || came_q.rest >= came_q.best)
  `SLOG_ASSERT(SlogDenseOutTail, !(tail_q && emit_q))
  `SLOG_ASSERT(SlogDenseOutValid, !(emit_q && good) || (pixel_q.found && pixel_q.best <= most_q))
  `SLOG_ASSERT_STABLE(SlogDenseOutStable, map_tvalid_o, map_tready_i,
                      {map_tuser_o, map_tlast_o, map_tdata_o})
endmodule : slog_dense_out
