// SPDX-License-Identifier: Apache-2.0
// First-in first-out queue in block RAM, with a short register queue behind the RAM's output register.
//
// Latency    : a word pushed in clock t is offered in clock t+5 at the earliest (register before the RAM, RAM write, RAM read,
//              output register, queue).
// Throughput : one push and one pop per clock, also when full (a pop frees its place in the clock after the next).
// With Kept  : the user asserts in_valid_i only with in_ready_o and out_ready_i only with out_valid_o. This is checked by an
//              assertion; the logic that would guard against it is left out.
// Formats    : opaque words of Width bits; level_o counts the words held in RAM, pipeline and queue, 0..Depth. It counts
//              a popped word for one clock longer.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_ram_fifo #(
    parameter  int unsigned Width  = 8,
    parameter  int unsigned Depth  = 16,
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
  `SLOG_ASSERT_INIT(SlogRamFifoDepth, Depth >= 2)
  localparam int unsigned AddrW = $clog2(Depth);
  localparam logic [AddrW-1:0] Last = AddrW'(Depth - 1);
  // For one word per clock the output queue needs one place for each clock from a read until its place is free again, and
  // one for the latest read, which free_q does not count yet.
  localparam int unsigned OutDepth = 6;
  localparam int unsigned OutLevelW = $clog2(OutDepth + 1);

  logic [AddrW-1:0] head_q, tail_q, after_tail_q;
  logic [AddrW-1:0] wr_addr_q;   // tail_q one clock later, with the word
  logic [AddrW-1:0] newest_q;    // place before wr_addr_q
  logic [Width-1:0] wr_data_q;
  logic [AddrW-1:0] front_q;     // place of the next word to leave
  logic [LevelW-1:0] level_q;    // words inside
  logic [OutDepth:0] free_q;     // places of the output queue not reserved, one-hot; a read is counted one clock late
  logic full_q, open_q;          // level_q == Depth; a separate copy of !full_q for level_q, to limit fan-out
  logic room_q;                  // two or more places free: the read of the clock before may have taken one of them
  logic read_q, read_q2;         // a word is in the RAM's first and second read stage
  logic push_q;                  // a word is written
  logic some;                    // the RAM holds a word that is not read yet
  logic push_q2;                 // such a word was written in the clock before
  // By the pointers of the clock before: the RAM holds an unread word; it holds one besides that at head_q.
  logic some_q, others_q;
  logic pop_q;                   // a word left; front_q and level_q follow one clock later, to keep pop's fan-out small
  logic push, pop, read, more, less, full;
  logic two;                     // free_q is two or more in the next clock
  logic [Width-1:0] ram_data;

  assign in_ready_o = !full_q;
  assign level_o    = level_q;
  assign push       = in_valid_i && (Kept || !full_q);
  assign pop        = out_ready_i && (Kept || out_valid_o);
  assign some       = push_q2 || (read_q ? others_q : some_q);
  assign read       = some && room_q;
  // after_tail_q == front_q: one place is left, level_q == Depth - 1.
  assign full       = !pop_q && (full_q || (in_valid_i && after_tail_q == front_q));
  assign more       = pop_q && !read_q;
  assign less       = read_q && !pop_q;
  assign two        = more ? !free_q[0] : less ? free_q[2:0] == '0 : room_q;

  function automatic logic [AddrW-1:0] after(logic [AddrW-1:0] place);
    return (place == Last) ? '0 : place + 1'b1;
  endfunction

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      head_q       <= '0;
      tail_q       <= '0;
      front_q      <= '0;
      after_tail_q <= after('0);
      wr_addr_q    <= '0;
      level_q      <= '0;
      free_q       <= (OutDepth + 1)'(1) << OutDepth;
      full_q       <= 1'b0;
      open_q       <= 1'b1;
      room_q       <= 1'b1;
      push_q       <= 1'b0;
      push_q2      <= 1'b0;
      some_q       <= 1'b0;
      others_q     <= 1'b0;
      pop_q        <= 1'b0;
      read_q       <= 1'b0;
      read_q2      <= 1'b0;
    end else begin
      if (push) begin
        tail_q       <= after_tail_q;
        after_tail_q <= after(after_tail_q);
      end
      if (read) head_q <= after(head_q);
      if (pop_q) front_q <= after(front_q);
      if ((in_valid_i && (Kept || open_q)) != pop_q) level_q <= level_q + LevelW'({LevelW{pop_q}} | 1'b1);
      // A multiplexer, not a clock enable: the enable would cost a level of logic.
      free_q    <= ({OutDepth + 1{more}} & free_q << 1) | ({OutDepth + 1{less}} & free_q >> 1)
                   | ({OutDepth + 1{!(more || less)}} & free_q);
      full_q    <= full;
      open_q    <= !full;
      room_q    <= two;
      push_q    <= push;
      push_q2   <= push_q;
      wr_addr_q <= tail_q;
      some_q    <= head_q != wr_addr_q;
      others_q  <= newest_q != head_q;
      pop_q     <= pop;
      read_q    <= read;
      read_q2   <= read_q;
    end
  end

  always_ff @(posedge clk_i) begin
    // The RAM blocks lie far apart: registers drive them directly, without logic.
    wr_data_q <= in_data_i;
    if (push_q) newest_q <= wr_addr_q;
  end

  slog_ram #(.Width(Width), .Depth(Depth)) u_ram (
      .clk_i, .wr_en_i(push_q), .wr_addr_i(wr_addr_q), .wr_data_i(wr_data_q),
      .rd_en_i(read), .rd_addr_i(head_q), .rd_data_o(ram_data));

  logic out_room;
  logic [OutLevelW-1:0] out_level;
  slog_fifo #(.Width(Width), .Depth(OutDepth), .Kept(1'b1)) u_out (
      .clk_i, .rst_i, .in_valid_i(read_q2), .in_ready_o(out_room), .in_data_i(ram_data),
      .out_valid_o, .out_ready_i(pop), .out_data_o, .level_o(out_level));

  `SLOG_ASSERT(SlogRamFifoOutHasRoom, !read_q2 || out_room)
  `SLOG_ASSERT(SlogRamFifoKept, !Kept || (!(in_valid_i && full_q) && !(out_ready_i && !out_valid_o)))
  // Places of the output queue that are occupied or reserved.
  logic [OutLevelW-1:0] taken;
  assign taken = out_level + OutLevelW'(read_q) + OutLevelW'(read_q2) + OutLevelW'(pop_q);
  `SLOG_ASSERT(SlogRamFifoPlaces, free_q == (OutDepth + 1)'(1) << (OutDepth - 32'(taken) + 32'(read_q)))
  `SLOG_ASSERT(SlogRamFifoFlags, full_q == (level_q == LevelW'(Depth)) && open_q == !full_q
                                 && some == (32'(level_q) != 32'(taken) + 32'(push_q))
                                 && room_q == (free_q[1:0] == '0))
endmodule : slog_ram_fifo
