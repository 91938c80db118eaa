// SPDX-License-Identifier: Apache-2.0
// Computes where a job's template and search rectangles lie in the store.
//
//   addr      = (slot * MaxHeight + y) * WordsPerRow + x / Width        shift = x mod Width
//   words_in  = (x + bits - 1) / Width - x / Width                      words_out = (bits - 1) / Width
//   template: bits = width, rows = height; search: bits = width + offsets_x - 1, rows = height + offsets_y - 1
//   words_in, words_out and rows are counts less one (load_t). The product is computed by shift and add.
//
// Latency    : tpl_o and search_o are valid from WordsBits + 5 clocks after start_i on, while job_i is stable.
// Throughput : one job at a time. The plan of a refused job is undefined.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_job_plan
  import slog_pkg::*, slog_fetch_pkg::*;
#(
    parameter  int unsigned Width       = 64,
    parameter  int unsigned MaxHeight   = 480,
    parameter  int unsigned WordsPerRow = 10,
    localparam int unsigned ShiftW      = $clog2(Width),
    localparam int unsigned WordsBits   = $clog2(WordsPerRow + 1),
    localparam int unsigned Steps       = WordsBits + 4
) (
    input  logic  clk_i,
    input  logic  rst_i,
    input  logic  start_i,
    input  job_t  job_i,
    output load_t tpl_o,
    output load_t search_o
);
  localparam int unsigned LineW = $clog2(8 * MaxHeight + 1024);

  // Pipeline registers: the job is far.
  logic start_q;
  // The tag is not used here.
  /* verilator lint_off UNUSEDSIGNAL */
  job_t job_q;
  /* verilator lint_on UNUSEDSIGNAL */
  logic [Steps-1:0] at_q;  // clocks since start_q, one-hot; [0] is the clock after it
  always_ff @(posedge clk_i) begin
    job_q <= job_i;
    if (rst_i) begin
      start_q <= 1'b0;
      at_q    <= '0;
    end else begin
      start_q <= start_i;
      at_q    <= {at_q[Steps-2:0], start_q};
    end
  end

  // First line of each slot.
  function automatic logic [7:0][LineW-1:0] first_lines();
    logic [7:0][LineW-1:0] lines;
    for (int unsigned s = 0; s < 8; s++) lines[s] = LineW'(s * MaxHeight);
    return lines;
  endfunction
  localparam logic [7:0][LineW-1:0] FirstLine = first_lines();

  function automatic logic [3:0] word_of(logic [9:0] column);
    return 4'(column >> ShiftW);
  endfunction

  // Sizes.
  logic [7:0] width_q, height_q;            // bits of a template row, and rows, less one
  logic [9:0] across_q, down_q;             // offsets, less one
  logic [9:0] span_q, search_rows_q;        // bits of a search row, and rows, less one
  logic [3:0] tpl_last_q, search_last_q;    // word of the row's last bit
  logic [3:0] tpl_words_q, search_words_q;
  always_ff @(posedge clk_i) begin
    if (start_q) begin
      width_q  <= job_q.width - 1'b1;
      height_q <= job_q.height - 1'b1;
      across_q <= job_q.offsets_x - 1'b1;
      down_q   <= job_q.offsets_y - 1'b1;
    end
    if (at_q[0]) begin
      span_q        <= across_q + 10'(width_q);
      search_rows_q <= down_q + 10'(height_q);
      tpl_last_q    <= word_of(job_q.tpl_x + 10'(width_q));
    end
    if (at_q[1]) begin
      search_last_q <= word_of(job_q.search_x + span_q);
      tpl_words_q   <= tpl_last_q - word_of(job_q.tpl_x);
    end
    if (at_q[2]) search_words_q <= search_last_q - word_of(job_q.search_x);
  end

  // Addresses: the line; WordsBits steps of shift and add, each one clock after its term is selected; the word.
  logic [LineW-1:0] tpl_first_q, search_first_q, tpl_line_q, search_line_q, tpl_term_q, search_term_q;
  logic [WordsBits-1:0] factor_q;
  logic [15:0] tpl_addr_q, search_addr_q;
  logic multiply_q;
  always_ff @(posedge clk_i) begin
    if (rst_i) multiply_q <= 1'b0;
    else multiply_q <= at_q[WordsBits:1] != '0;
  end
  always_ff @(posedge clk_i) begin
    if (start_q) begin
      tpl_first_q    <= FirstLine[job_q.tpl_slot];
      search_first_q <= FirstLine[job_q.search_slot];
    end
    if (at_q[0]) begin
      tpl_line_q    <= tpl_first_q + LineW'(job_q.tpl_y);
      search_line_q <= search_first_q + LineW'(job_q.search_y);
      factor_q      <= WordsBits'(WordsPerRow);
    end else begin
      factor_q      <= factor_q << 1;
    end
    tpl_term_q    <= factor_q[WordsBits-1] ? tpl_line_q : '0;
    search_term_q <= factor_q[WordsBits-1] ? search_line_q : '0;
    if (at_q[0]) begin
      tpl_addr_q    <= '0;
      search_addr_q <= '0;
    end else if (multiply_q) begin
      tpl_addr_q    <= (tpl_addr_q << 1) + 16'(tpl_term_q);
      search_addr_q <= (search_addr_q << 1) + 16'(search_term_q);
    end else if (at_q[WordsBits+2]) begin
      tpl_addr_q    <= tpl_addr_q + 16'(word_of(job_q.tpl_x));
      search_addr_q <= search_addr_q + 16'(word_of(job_q.search_x));
    end
  end

  assign tpl_o = '{
          addr: tpl_addr_q,
          shift: 6'(job_q.tpl_x[ShiftW-1:0]),
          words_in: tpl_words_q,
          words_out: word_of(10'(width_q)),
          rows: 10'(height_q)
      };
  assign search_o = '{
          addr: search_addr_q,
          shift: 6'(job_q.search_x[ShiftW-1:0]),
          words_in: search_words_q,
          words_out: word_of(span_q),
          rows: search_rows_q
      };

  `SLOG_ASSERT_INIT(SlogJobPlanShift, ShiftW <= 6 && ShiftW >= 2)
  `SLOG_ASSERT_INIT(SlogJobPlanWords, WordsPerRow <= 15 && 8 * MaxHeight * WordsPerRow <= 65536)
  `SLOG_PAST(past_job, job_i)
  `SLOG_ASSERT(SlogJobPlanStable, !(start_q || |at_q) || job_i == past_job)
  `SLOG_ASSERT(SlogJobPlanOneAtATime, !(start_q && |at_q))
endmodule : slog_job_plan
