// SPDX-License-Identifier: Apache-2.0
// Checks a job of the dense engine, and computes once for the pass what its rows need.
//
//   first       = max(0, -start - Offsets + 1)               the first right column that a left pixel meets
//   column      = first - skip, skip = first mod Width       where the right rows begin
//   ahead       = start + column                             clocks from the left row to the right one, negative: before it
//   count       = image_width - max(start, 0) - column
//   pitch       = max(image_width + 2 * Lanes + 1, Offsets + Width + 8)
//   words       = ceil(image_width / step_x), by subtracting
//   right       = slot's first word - down * WordsPerRow + column / Width, by adding
//
// Why the pitch: more than 2 * Lanes clocks lie between left rows; the longest delay, Offsets + Width - 2, is over before the
// next row; and of rows no more than two meet in any lane, which have different parities.
//
// Clocks     : as many as the map has words in a row, or as down has rows, 8 at least, and 3.
// Latency    : done_o is high in that clock after start_i; plan_o and status_o are valid from it on, while job_i is stable.
// Throughput : one job at a time. The plan of a refused job is undefined.
// Rules      : of a live job here_i counts instead of slot_valid_i: from 2 clocks after start_i to done_o.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_dense_plan
  import slog_dense_pkg::*;
  import slog_compare_pkg::*;
#(
    parameter int unsigned Width       = 64,
    parameter int unsigned MaxHeight   = 480,
    parameter int unsigned WordsPerRow = 10,
    parameter int unsigned Slots       = 3,
    parameter int unsigned Offsets     = 128,
    parameter int unsigned Lanes       = 8,
    parameter int unsigned MaxWindow   = 32,
    parameter int unsigned Sizes       = 3
) (
    input  logic                clk_i,
    input  logic                rst_i,
    input  logic                start_i,
    // The limits of what is valid do not matter here.
    /* verilator lint_off UNUSEDSIGNAL */
    input  dense_job_t          job_i,
    /* verilator lint_on UNUSEDSIGNAL */
    input  logic          [9:0] image_width_i,
    input  logic          [9:0] image_height_i,
    input  logic          [7:0] slot_valid_i,
    input  logic          [1:0] here_i,        // of a live job: the left, the right slot holds a frame or will
    output logic                done_o,
    output dense_status_e       status_o,
    output plan_t               plan_o
);
  localparam int unsigned BitW   = $clog2(Width);
  localparam int unsigned Settle = 8;
  localparam int unsigned LeastPitch = Offsets + Width + 8;
  typedef logic signed [11:0] span_t;

  // First word of each slot.
  function automatic logic [7:0][15:0] first_words();
    logic [7:0][15:0] words;
    for (int unsigned s = 0; s < 8; s++) words[s] = 16'(s * MaxHeight * WordsPerRow);
    return words;
  endfunction
  localparam logic [7:0][15:0] FirstWord = first_words();

  // Check. Every stage runs freely, for the job is stable; the slots are looked at in start_i's clock.
  logic [Sizes-1:0] size_q;
  logic wide_q, tall_q, none_q, many_q, left_q, right_q, step_q;
  logic [7:0] slot_valid_q;
  logic [2:0] left_slot_q, right_slot_q;
  dense_status_e status_q;
  always_ff @(posedge clk_i) begin
    for (int unsigned s = 0; s < Sizes; s++) size_q[s] <= 32'(job_i.window) == MaxWindow >> s;
    wide_q       <= is_above(32'(job_i.window), 32'(image_width_i));
    tall_q       <= is_above(32'(job_i.window), 32'(image_height_i));
    none_q       <= job_i.offsets == '0;
    many_q       <= 32'(job_i.offsets) > Offsets;
    if (start_i) slot_valid_q <= slot_valid_i;
    left_slot_q  <= job_i.left_slot;
    right_slot_q <= job_i.right_slot;
    left_q       <= 32'(left_slot_q) < Slots && (job_i.live ? here_i[0] : slot_valid_q[left_slot_q]);
    right_q      <= 32'(right_slot_q) < Slots && (job_i.live ? here_i[1] : slot_valid_q[right_slot_q]);
    step_q       <= job_i.step_x != '0 && job_i.step_y != '0;
    status_q     <= size_q == '0 || wide_q || tall_q ? DenseBadWindow :
                    none_q || many_q ? DenseBadOffsets :
                    !(left_q && right_q) ? DenseBadSlot :
                    !step_q ? DenseBadStep : DenseOk;
  end

  // Columns and delays, likewise: one adder a stage.
  logic [2:0] shrink_q;
  logic [9:0] mask_q;
  logic [15:0] above_q;
  logic signed [10:0] before_q;
  logic signed [9:0] ahead_q;
  logic [9:0] cut_q;                            // columns at the right plane's end that no left pixel meets
  span_t end_q;
  logic [9:0] first_q, count_q;
  logic [10:0] row_q, pitch_q;
  logic [9:0] left_delay_q, right_delay_q, column, skip;
  logic meets_q, long_q;
  // a < b. Only the sign of the difference is used.
  function automatic logic is_below(logic [9:0] a, span_t b);
    /* verilator lint_off UNUSEDSIGNAL */
    span_t difference = span_t'({2'b00, a}) - b;
    /* verilator lint_on UNUSEDSIGNAL */
    return difference[11];
  endfunction
  assign skip   = 10'(first_q[BitW-1:0]);
  assign column = {first_q[9:BitW], BitW'(0)};
  always_ff @(posedge clk_i) begin
    shrink_q <= '0;
    above_q  <= 16'(MaxWindow * WordsPerRow);
    for (int unsigned s = 1; s < Sizes; s++) begin
      if (size_q[s]) begin
        shrink_q <= 3'(s);
        above_q  <= 16'((MaxWindow >> s) * WordsPerRow);
      end
    end
    mask_q   <= -10'(job_i.window);
    before_q <= 11'(1 - int'(Offsets)) - 11'(job_i.start);
    first_q  <= before_q[10] ? '0 : before_q[9:0];
    cut_q    <= job_i.start[9] ? '0 : job_i.start;
    end_q    <= span_t'({2'b00, image_width_i}) - span_t'({2'b00, cut_q});
    ahead_q  <= job_i.start + signed'(column);
    count_q  <= end_q[9:0] - column;
    meets_q  <= is_below(first_q, end_q);
    left_delay_q  <= ahead_q[9] ? -ahead_q : '0;
    right_delay_q <= ahead_q[9] ? '0 : ahead_q;
    row_q    <= 11'(image_width_i) + 11'(2 * Lanes + 1);
    long_q   <= is_above(32'(row_q), LeastPitch);
    pitch_q  <= long_q ? row_q : 11'(LeastPitch);
  end

  // What takes as long as it is large: rows down, words of a row.
  logic start_q, up_q, going_q, bad_q, over_q;
  logic [Settle-1:0] at_q;
  logic [10:0] rows_q, columns_q, last_q;       // left to go, less one: negative at the end
  logic signed [9:0] distance_q;
  logic [9:0] words_q;
  logic [15:0] lines_q, right_addr_q, left_addr_q, right_first_q, over_words_q;
  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      start_q <= 1'b0;
      going_q <= 1'b0;
      over_q  <= 1'b0;
      at_q    <= '0;
    end else begin
      start_q <= start_i;
      going_q <= start_q || (going_q && !over_q);
      over_q  <= going_q && !over_q && at_q[Settle-1] && (bad_q || (rows_q[10] && columns_q[10]));
      at_q    <= start_q ? '0 : {at_q[Settle-2:0], 1'b1};
    end
  end
  always_ff @(posedge clk_i) begin
    up_q          <= !job_i.down[9];
    distance_q    <= job_i.down[9] ? -job_i.down : job_i.down;
    bad_q         <= status_q != DenseOk;
    last_q        <= 11'(image_width_i) - 1'b1;
    left_addr_q   <= FirstWord[left_slot_q];
    right_first_q <= FirstWord[right_slot_q];
    over_words_q  <= 16'(column >> BitW) + right_first_q;
    right_addr_q  <= lines_q + over_words_q;
    if (start_q) begin
      rows_q    <= 11'(unsigned'(distance_q)) - 1'b1;
      columns_q <= last_q;
      words_q   <= '0;
      lines_q   <= '0;
    end else begin
      if (!rows_q[10]) begin
        rows_q  <= rows_q - 1'b1;
        lines_q <= up_q ? lines_q - 16'(WordsPerRow) : lines_q + 16'(WordsPerRow);
      end
      if (!columns_q[10]) begin
        columns_q <= columns_q - 11'(job_i.step_x);
        words_q   <= words_q + 1'b1;
      end
    end
  end

  assign done_o   = over_q;
  assign status_o = status_q;
  assign plan_o   = '{
          shrink: shrink_q,
          mask: mask_q,
          left: left_addr_q,
          right: right_addr_q,
          above: above_q,
          pitch: pitch_q,
          left_delay: left_delay_q,
          right_delay: right_delay_q,
          column: column,
          skip: skip,
          count: count_q,
          meets: meets_q,
          words: words_q
      };

  `SLOG_ASSERT_INIT(SlogDensePlanWidth, Width == 2 ** BitW && BitW <= 9)
  `SLOG_ASSERT_INIT(SlogDensePlanWords, 8 * MaxHeight * WordsPerRow <= 65536)
  `SLOG_ASSERT_INIT(SlogDensePlanSizes, Sizes >= 1 && Sizes <= 6 && MaxWindow <= 32 && Offsets <= 256)
  `SLOG_PAST(past_job, job_i)
  `SLOG_ASSERT(SlogDensePlanStable, !(start_q || going_q) || job_i == past_job)
  `SLOG_ASSERT(SlogDensePlanOneAtATime, !(start_i && (start_q || going_q)))
endmodule : slog_dense_plan
