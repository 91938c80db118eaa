// First-in first-out queue with registered storage and flags and a combinational front.
//
// Latency    : a word pushed in clock t is offered in clock t+1.
// Throughput : one push and one pop per clock, also when full (a pop frees its place in the next clock).
// With Kept  : its user promises in_valid_i only with in_ready_o and out_ready_i only with out_valid_o; that is asserted,
//              and no logic looks after it.
// Formats    : opaque words of Width bits; level_o counts the words held, 0..Depth.
`include "slog_assert.svh"
module slog_fifo #(
    parameter  int unsigned Width  = 8,
    parameter  int unsigned Depth  = 4,
    parameter  bit          Kept   = 1'b0,
    localparam int unsigned LevelW = $clog2(Depth + 1)
) (
    input  logic              clk_i,
    input  logic              rst_i,
    input  logic              in_valid_i,
    output logic              in_ready_o,
    input  logic [Width-1:0]  in_data_i,
    output logic              out_valid_o,
    input  logic              out_ready_i,
    output logic [Width-1:0]  out_data_o,
    output logic [LevelW-1:0] level_o
);
  localparam int unsigned AddrW = (Depth > 1) ? $clog2(Depth) : 1;
  localparam logic [AddrW-1:0] Last = AddrW'(Depth - 1);

  logic [Width-1:0] mem_q[Depth];
  logic [AddrW-1:0] head_q, tail_q, after_head_q, after_tail_q;
  logic [LevelW-1:0] level_q;
  logic full_q, some_q;  // level_q == Depth; level_q != 0
  logic none_q;          // !some_q: apart from it, for the user's logic
  logic push, pop, some;

  assign in_ready_o  = !full_q;
  assign out_valid_o = !none_q;
  assign out_data_o  = mem_q[head_q];
  assign level_o     = level_q;
  assign push        = in_valid_i && (Kept || !full_q);
  assign pop         = out_ready_i && (Kept || some_q);
  // One word is left: level_q == 1.
  assign some        = push || (some_q && !(out_ready_i && after_head_q == tail_q));

  function automatic logic [AddrW-1:0] after(logic [AddrW-1:0] place);
    return (place == Last) ? '0 : place + 1'b1;
  endfunction

  always_ff @(posedge clk_i) begin
    if (push) mem_q[tail_q] <= in_data_i;
  end

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      head_q       <= '0;
      tail_q       <= '0;
      after_head_q <= after('0);
      after_tail_q <= after('0);
      level_q      <= '0;
      full_q       <= 1'b0;
      some_q       <= 1'b0;
      none_q       <= 1'b1;
    end else begin
      if (push) begin
        tail_q       <= after_tail_q;
        after_tail_q <= after(after_tail_q);
      end
      if (pop) begin
        head_q       <= after_head_q;
        after_head_q <= after(after_head_q);
      end
      if (push != pop) level_q <= push ? level_q + 1'b1 : level_q - 1'b1;
      // One place is left: level_q == Depth - 1.
      full_q <= !pop && (full_q || (in_valid_i && after_tail_q == head_q));
      some_q <= some;
      none_q <= !some;
    end
  end

  `SLOG_ASSERT(SlogFifoLevelInRange, level_q <= LevelW'(Depth))
  `SLOG_ASSERT(SlogFifoFlags, full_q == (level_q == LevelW'(Depth)) && some_q == (level_q != '0))
  `SLOG_ASSERT(SlogFifoKept, !Kept || (!(in_valid_i && full_q) && !(out_ready_i && !some_q)))
  `SLOG_ASSERT_STABLE(SlogFifoOutStable, out_valid_o, out_ready_i, out_data_o)
endmodule : slog_fifo
