// One camera's captures: writes the words of the next good frame after a request into the slot asked for.
//
// armed      : after the next frame_start_i the slot's valid bit is cleared (clear_o).
// check      : CheckClocks later the slot must not be in use by the correlator any more; else this frame is given up (set_o
//              puts the valid bit back) and the request waits for the next one.
// write      : words go to consecutive addresses, each row at a multiple of WordsPerRow; frame_abort_i goes back to armed.
// finish     : after frame_done_i, when the last word is on its way to the store, set_o sets the valid bit (finish_o).
//
// Latency    : a word leaves in the clock after it came when the store is free.
// Throughput : a word per clock in, as fast out as the store takes it; FifoDepth covers two cameras' narrow row ends.
`include "slog_assert.svh"
module slog_capture_channel #(
    parameter  int unsigned GroupBits   = 64,
    parameter  int unsigned Slots       = 6,
    parameter  int unsigned SlotWords   = 4800,
    parameter  int unsigned WordsPerRow = 10,
    localparam int unsigned AddrW       = $clog2(Slots * SlotWords)
) (
    input  logic                 clk_i,
    input  logic                 rst_i,
    input  logic                 ask_i,           // a command with a slot that may be taken
    input  logic                 arm_i,           // take slot_i as the request: ask_i, not while writing_o
    input  logic                 cancel_i,
    input  logic [2:0]           slot_i,
    input  logic                 slot_busy_i,     // slot_mask_o's is being read
    input  logic                 slot_valid_i,    // slot_mask_o's holds a frame
    input  logic                 word_valid_i,
    input  logic [GroupBits-1:0] word_data_i,
    input  logic                 word_last_i,
    input  logic                 frame_start_i,
    input  logic                 frame_done_i,
    input  logic                 frame_abort_i,
    output logic                 pushed_o,        // a word came in the clock before
    output logic                 wr_valid_o,
    input  logic                 wr_ready_i,
    output logic [AddrW-1:0]     wr_addr_o,
    output logic [GroupBits-1:0] wr_data_o,
    output logic [2:0]           slot_o,
    output logic [7:0]           slot_mask_o,     // the same one-hot, a clock later
    output logic                 armed_o,         // a request waits or is being served, with this clock's command in it
    output logic                 held_o,          // ... without
    output logic                 free_o,          // the contrary
    output logic                 writing_o,       // from frame start to finish
    output logic                 clear_o,         // slot_mask_o's valid bit is to be cleared
    output logic                 set_o,           // ... set
    output logic                 finish_o         // ... set for a new frame
);
  localparam int unsigned FifoDepth = 4;
  localparam int unsigned LevelW = $clog2(FifoDepth + 1);
  // The slot shows as invalid from the second; what the correlator reads is looked at in the last but one.
  localparam logic [2:0] CheckClocks = 3'd5;

  logic wait_q, checking_q, writing_q, finishing_q;  // one at most; none: idle
  logic held_q;                                      // any of them
  logic free_q;                                      // none
  logic serving_q;                                   // any but the first
  logic pass_q, give_q;                              // a check ends in this clock: the frame is written, or given up
  logic [2:0] slot_q, slot_q2, check_q;
  logic [7:0] slot_mask_q;
  logic load_q, was_valid_q, clear_q, set_q, judge, finish_q, restore, finish, pushed_q, start, held, back, push, ready;
  logic [AddrW-1:0] addr_q, next_row_q, base_q, base_row_q, slot_base;
  /* verilator lint_off UNUSEDSIGNAL */
  logic [LevelW-1:0] level;
  /* verilator lint_on UNUSEDSIGNAL */

  assign push        = word_valid_i && writing_q;
  assign start       = wait_q && frame_start_i && !ask_i && !cancel_i;
  assign held        = !cancel_i && (arm_i || (held_q && !finish_q));
  assign judge       = check_q == 3'd1;
  assign back        = (checking_q && (give_q || frame_abort_i)) || (writing_q && frame_abort_i);
  assign restore     = judge && checking_q && slot_busy_i && was_valid_q && !frame_abort_i && !cancel_i;
  assign finish      = finishing_q && !wr_valid_o && !finish_q && !cancel_i;
  assign clear_o     = clear_q;
  assign set_o       = set_q;
  assign finish_o    = finish_q;
  assign slot_o      = slot_q;
  assign slot_mask_o = slot_mask_q;
  assign pushed_o    = pushed_q;
  assign armed_o     = !cancel_i && (arm_i || held_q);
  assign held_o      = held_q;
  assign free_o      = free_q;
  assign writing_o   = serving_q;

  always_comb begin
    slot_base = '0;
    for (int unsigned s = 0; s < Slots; s++) begin
      if (slot_q2 == 3'(s)) slot_base = AddrW'(s * SlotWords);
    end
  end

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      held_q      <= 1'b0;
      free_q      <= 1'b1;
      serving_q   <= 1'b0;
      wait_q      <= 1'b0;
      checking_q  <= 1'b0;
      writing_q   <= 1'b0;
      finishing_q <= 1'b0;
      clear_q     <= 1'b0;
      pass_q      <= 1'b0;
      give_q      <= 1'b0;
      set_q       <= 1'b0;
      finish_q    <= 1'b0;
    end else begin
      held_q      <= held;
      free_q      <= !held;
      serving_q   <= start || (serving_q && !back && !finish_q && !cancel_i);
      wait_q      <= !cancel_i && (arm_i || back || (wait_q && !frame_start_i));
      checking_q  <= start || (checking_q && !back && !pass_q && !cancel_i);
      writing_q   <= !frame_abort_i && !cancel_i && ((checking_q && pass_q) || (writing_q && !frame_done_i));
      finishing_q <= !cancel_i && ((writing_q && !frame_abort_i && frame_done_i) || (finishing_q && !finish_q));
      clear_q     <= start;
      pass_q      <= judge && !slot_busy_i;
      give_q      <= judge && slot_busy_i;
      set_q       <= restore || finish;
      finish_q    <= finish;
    end
  end

  // A frame's words come many clocks after its slot's base is known.
  always_ff @(posedge clk_i) begin
    if (arm_i) slot_q <= slot_i;
    slot_q2     <= slot_q;
    slot_mask_q <= 8'd1 << slot_q;
    base_q      <= slot_base;
    base_row_q  <= slot_base + AddrW'(WordsPerRow);
    if (clear_q) was_valid_q <= slot_valid_i;
    if (wait_q) check_q <= CheckClocks - 3'd1;
    else if (check_q != '0) check_q <= check_q - 1'b1;
    load_q <= !writing_q;
    pushed_q <= push && ready;
    if (load_q) begin
      addr_q     <= base_q;
      next_row_q <= base_row_q;
    end else if (word_valid_i) begin
      addr_q <= word_last_i ? next_row_q : addr_q + 1'b1;
      if (word_last_i) next_row_q <= next_row_q + AddrW'(WordsPerRow);
    end
  end

  slog_fifo #(
      .Width(AddrW + GroupBits),
      .Depth(FifoDepth)
  ) u_fifo (
      .clk_i,
      .rst_i,
      .in_valid_i (push),
      .in_ready_o (ready),
      .in_data_i  ({addr_q, word_data_i}),
      .out_valid_o(wr_valid_o),
      .out_ready_i(wr_ready_i),
      .out_data_o ({wr_addr_o, wr_data_o}),
      .level_o    (level)
  );

  `SLOG_ASSERT(SlogCaptureRoom, push |-> ready)
  `SLOG_ASSERT(SlogCaptureNoEarlyWord, checking_q || (writing_q && load_q) |-> !word_valid_i)
  `SLOG_ASSERT(SlogCaptureArmWhenFree, arm_i == (ask_i && !writing_o))
  `SLOG_ASSERT(SlogCaptureStates, $onehot0({wait_q, checking_q, writing_q, finishing_q}))
  `SLOG_ASSERT(SlogCaptureServing, serving_q == (checking_q || writing_q || finishing_q) &&
                                   held_q == (wait_q || serving_q) && free_q == !held_q)
endmodule : slog_capture_channel
