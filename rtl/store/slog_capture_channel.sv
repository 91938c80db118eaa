// SPDX-License-Identifier: Apache-2.0
// One camera's captures: writes the words of the next good frame after a request into the requested slot.
//
// armed      : after the next frame_start_i the slot's valid bit is cleared (clear_o).
// check      : CheckClocks later the correlator must no longer be using the slot; else this frame is skipped (set_o restores
//              the valid bit) and the request waits for the next one. slot_busy_i may be one clock late.
// write      : words go to consecutive addresses, each row at a multiple of WordsPerRow; frame_abort_i returns to armed.
// finish     : after frame_done_i, when the last word has left the queue, set_o sets the valid bit (finish_o).
//
//   stage  registers
//   1      inputs from the front end; whether the correlator reads the slot
//   2      push_o, with the word and its address for the queue (slog_capture_slice)
//   3      the queue's level: empty_o
//   4      progress_o.rows, when the queue is empty: the rows whose words have all left it
// Latency    : word_valid_i to push_o 2 clocks, empty_o falls one clock later; frame_done_i to set_o 4 + Hops clocks when
//              the queue is empty, else 3 + Hops after the last word has left it: the words reach the queue Hops clocks
//              after they are counted in its level.
// Throughput : one word per clock in, out as fast as the store accepts; Depth suffices for the short last words of two
//              cameras' rows.
// Progress   : progress_o.rows counts a row 2 clocks after its last word has left the queue, or later if another waits then,
//              which is 2 clocks before that word is at the store's write port (Hops = 2), and 4 before it may be read.
//              progress_o.writing begins when the check is over, so a slot that the check finds busy is not touched.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_capture_channel
  import slog_store_pkg::*;
#(
    parameter  int unsigned GroupBits   = 64,
    parameter  int unsigned Slots       = 6,
    parameter  int unsigned SlotWords   = 4800,
    parameter  int unsigned WordsPerRow = 10,
    parameter  int unsigned Depth       = 4,
    parameter  int unsigned Hops        = 2,
    parameter  bit          Progress    = 1'b0,
    localparam int unsigned AddrW       = $clog2(Slots * SlotWords)
) (
    input  logic                 clk_i,
    input  logic                 rst_i,
    input  logic                 ask_i,           // a command whose slot the other camera does not hold
    input  logic                 arm_i,           // accept slot_i as the request: ask_i && !writing_o
    input  logic                 cancel_i,
    input  logic [2:0]           slot_i,
    input  logic                 slot_busy_i,     // the slot in slot_mask_o is being read
    input  logic                 slot_valid_i,    // the slot in slot_mask_o holds a frame
    input  logic                 word_valid_i,
    input  logic [GroupBits-1:0] word_data_i,
    input  logic                 word_last_i,
    input  logic                 frame_start_i,
    input  logic                 frame_done_i,
    input  logic                 frame_abort_i,
    output logic                 push_o,          // a word enters the queue
    output logic [AddrW-1:0]     addr_o,
    output logic [GroupBits-1:0] data_o,
    output logic                 empty_o,         // the queue holds no word
    input  logic                 pop_i,           // a word leaves the queue; only if !empty_o
    output logic [2:0]           slot_o,
    output logic [7:0]           slot_mask_o,     // slot_o one-hot, one clock later
    output logic                 armed_o,         // a request waits or is being served, including this clock's command
    output logic                 held_o,          // as armed_o, before this clock's command
    output logic                 free_o,          // !held_o
    output logic                 writing_o,       // from frame start to finish
    output logic                 clear_o,         // clear the valid bit of the slot in slot_mask_o
    output logic                 set_o,           // set that valid bit
    output logic                 finish_o,        // set_o is for a new frame
    output progress_t            progress_o       // 0 without Progress
);
  // Clocks from start to the decision. In clock 2 the valid bit is cleared, while slog_fetch, one register later, may still
  // check a job against the old bit; such a job marks the slot busy in that clock. Through two registers, of slog_capture
  // and slot_busy_q, the mark is read in clock 4; pass_q and give_q hold the decision in clock 5.
  localparam logic [2:0] CheckClocks = 3'd5;

  logic wait_q, checking_q, writing_q, finishing_q;  // at most one is set; none: idle
  logic held_q;                                      // any of the four
  logic free_q;                                      // none of the four
  logic serving_q;                                   // any but wait_q
  logic pass_q, give_q;                              // a check ends in this clock: the frame is written, or skipped
  logic [2:0] slot_q, slot_q2, slot_q3, check_q;
  logic [7:0] slot_mask_q;
  logic word_q, last_q, frame_start_q, frame_done_q, frame_abort_q, slot_busy_q;
  logic came_q, last_q2, push_q;                     // word_q one clock later; the same, and the word is written
  logic [GroupBits-1:0] data_q, data_q2;
  logic load_q, was_valid_q, clear_q, set_q, judge, finish_q, restore, finish, start, held, back;
  logic [Hops:0] left_q;                             // [n]: finishing, and the queue was empty n clocks ago
  logic [AddrW-1:0] addr_q, next_row_q, base_q, base_row_q, slot_base;
  logic [Depth:0] level_q;                           // words in the queue, one-hot
  logic up, down;

  assign start       = wait_q && frame_start_q && !ask_i && !cancel_i;
  assign held        = !cancel_i && (arm_i || (held_q && !finish_q));
  assign judge       = check_q == 3'd1;
  assign back        = (checking_q && (give_q || frame_abort_q)) || (writing_q && frame_abort_q);
  assign restore     = judge && checking_q && slot_busy_q && was_valid_q && !frame_abort_q && !cancel_i;
  assign finish      = finishing_q && left_q[Hops] && !finish_q && !cancel_i;
  assign clear_o     = clear_q;
  assign set_o       = set_q;
  assign finish_o    = finish_q;
  assign slot_o      = slot_q;
  assign slot_mask_o = slot_mask_q;
  assign armed_o     = !cancel_i && (arm_i || held_q);
  assign held_o      = held_q;
  assign free_o      = free_q;
  assign writing_o   = serving_q;
  assign push_o      = push_q;
  assign addr_o      = addr_q;
  assign data_o      = data_q2;
  assign empty_o     = level_q[0];
  assign up          = push_q && !pop_i;
  assign down        = pop_i && !push_q;

  always_comb begin
    slot_base = '0;
    for (int unsigned s = 0; s < Slots; s++) begin
      if (slot_q3 == 3'(s)) slot_base = AddrW'(s * SlotWords);
    end
  end

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      held_q        <= 1'b0;
      free_q        <= 1'b1;
      serving_q     <= 1'b0;
      wait_q        <= 1'b0;
      checking_q    <= 1'b0;
      writing_q     <= 1'b0;
      finishing_q   <= 1'b0;
      clear_q       <= 1'b0;
      pass_q        <= 1'b0;
      give_q        <= 1'b0;
      set_q         <= 1'b0;
      left_q        <= '0;
      finish_q      <= 1'b0;
      word_q        <= 1'b0;
      came_q        <= 1'b0;
      push_q        <= 1'b0;
      level_q       <= (Depth + 1)'(1);
      frame_start_q <= 1'b0;
      frame_done_q  <= 1'b0;
      frame_abort_q <= 1'b0;
    end else begin
      word_q        <= word_valid_i;
      frame_start_q <= frame_start_i;
      frame_done_q  <= frame_done_i;
      frame_abort_q <= frame_abort_i;
      came_q        <= word_q;
      push_q        <= word_q && writing_q;
      level_q       <= ({Depth + 1{up}} & level_q << 1) | ({Depth + 1{down}} & level_q >> 1)
                     | ({Depth + 1{!(up || down)}} & level_q);
      held_q        <= held;
      free_q        <= !held;
      serving_q     <= start || (serving_q && !back && !finish_q && !cancel_i);
      wait_q        <= !cancel_i && (arm_i || back || (wait_q && !frame_start_q));
      checking_q    <= start || (checking_q && !back && !pass_q && !cancel_i);
      writing_q     <= !frame_abort_q && !cancel_i && ((checking_q && pass_q) || (writing_q && !frame_done_q));
      finishing_q   <= !cancel_i && ((writing_q && !frame_abort_q && frame_done_q) || (finishing_q && !finish_q));
      clear_q       <= start;
      pass_q        <= judge && !slot_busy_q;
      give_q        <= judge && slot_busy_q;
      set_q         <= restore || finish;
      left_q        <= {Hops + 1{finishing_q}} & {left_q[Hops-1:0], !push_q && level_q[0]};
      finish_q      <= finish;
    end
  end

  // slot_base needs no reset and no enable: a frame's words arrive many clocks after its slot is known.
  always_ff @(posedge clk_i) begin
    slot_busy_q <= slot_busy_i;
    last_q      <= word_last_i;
    last_q2     <= last_q;
    data_q      <= word_data_i;
    data_q2     <= data_q;
    if (arm_i) slot_q <= slot_i;
    slot_q2     <= slot_q;
    slot_q3     <= slot_q2;
    slot_mask_q <= 8'd1 << slot_q;
    base_q      <= slot_base;
    base_row_q  <= base_q + AddrW'(WordsPerRow);
    if (clear_q) was_valid_q <= slot_valid_i;
    if (wait_q) check_q <= CheckClocks - 3'd1;
    else if (check_q != '0) check_q <= check_q - 1'b1;
    load_q <= !writing_q;
    if (load_q) begin
      addr_q     <= base_q;
      next_row_q <= base_row_q;
    end else if (came_q) begin
      addr_q <= last_q2 ? next_row_q : addr_q + 1'b1;
      if (last_q2) next_row_q <= next_row_q + AddrW'(WordsPerRow);
    end
  end

  if (Progress) begin : g_progress
    logic [9:0] pushed_q, rows_q;  // rows of the frame that have entered the queue, and left it
    // A row has left when the queue is empty that it has entered.
    always_ff @(posedge clk_i) begin
      if (rst_i || wait_q) begin
        pushed_q <= '0;
        rows_q   <= '0;
      end else begin
        if (push_q && last_q2) pushed_q <= pushed_q + 1'b1;
        if (level_q[0]) rows_q <= pushed_q;
      end
    end
    assign progress_o = '{
            held: held_q,
            writing: writing_q || finishing_q,
            done: finish_q,
            slot: slot_q & {3{held_q}},
            rows: rows_q
        };
  end else begin : g_no_progress
    assign progress_o = '0;
  end

  `SLOG_ASSERT(SlogCaptureLevel, $onehot(level_q))
  `SLOG_ASSERT(SlogCaptureDone, !finish_q || finishing_q)
  `SLOG_ASSERT(SlogCaptureRoom, !push_q || !level_q[Depth])
  `SLOG_ASSERT(SlogCaptureWaits, !pop_i || !level_q[0])
  `SLOG_ASSERT(SlogCaptureNoEarlyWord, !(checking_q || (writing_q && load_q)) || !word_q)
  `SLOG_ASSERT(SlogCaptureArmWhenFree, arm_i == (ask_i && !writing_o))
  `SLOG_ASSERT(SlogCaptureStates, $onehot0({wait_q, checking_q, writing_q, finishing_q}))
  `SLOG_ASSERT(SlogCaptureServing, serving_q == (checking_q || writing_q || finishing_q) &&
                                   held_q == (wait_q || serving_q) && free_q == !held_q)
endmodule : slog_capture_channel
