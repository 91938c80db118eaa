// One camera's captures: writes the words of the next good frame after a request into the slot asked for.
//
// armed      : the next frame_start_i clears the slot's valid bit (start_o).
// check      : CheckClocks after that the slot must not be in use by the correlator any more; else this frame is given up
//              (restore_o puts the valid bit back) and the request waits for the next one.
// write      : words go to consecutive addresses, each row at a multiple of WordsPerRow; frame_abort_i goes back to armed.
// finish     : after frame_done_i, when the last word is on its way to the store, finish_o sets the valid bit.
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
    input  logic                 arm_i,           // take slot_i as the request; not while writing_o
    input  logic                 cancel_i,
    input  logic [2:0]           slot_i,
    input  logic                 slot_busy_i,     // slot_o is being read
    input  logic                 slot_valid_i,    // slot_o holds a frame
    input  logic                 word_valid_i,
    input  logic [GroupBits-1:0] word_data_i,
    input  logic                 word_last_i,
    input  logic                 frame_start_i,
    input  logic                 frame_done_i,
    input  logic                 frame_abort_i,
    output logic                 wr_valid_o,
    input  logic                 wr_ready_i,
    output logic [AddrW-1:0]     wr_addr_o,
    output logic [GroupBits-1:0] wr_data_o,
    output logic [2:0]           slot_o,
    output logic                 armed_o,         // a request waits or is being served
    output logic                 writing_o,       // from frame start to finish
    output logic                 start_o,
    output logic                 restore_o,
    output logic                 finish_o
);
  localparam int unsigned FifoDepth = 4;
  localparam int unsigned LevelW = $clog2(FifoDepth + 1);
  localparam logic [1:0] CheckClocks = 2'd3;
  typedef enum logic [2:0] {Idle, Armed, Check, Write, Finish} state_e;

  state_e state_q;
  logic [2:0] slot_q;
  logic [1:0] check_q;
  logic was_valid_q, push, ready;
  logic [AddrW-1:0] row_q, addr_q, slot_base;
  logic [LevelW-1:0] level;

  assign push      = word_valid_i && state_q == Write;
  assign start_o   = state_q == Armed && frame_start_i && !arm_i && !cancel_i;
  assign restore_o = state_q == Check && check_q == '0 && slot_busy_i && was_valid_q;
  assign finish_o  = state_q == Finish && level == '0;
  assign slot_o    = slot_q;
  assign armed_o   = state_q != Idle;
  assign writing_o = state_q == Check || state_q == Write || state_q == Finish;

  always_comb begin
    slot_base = '0;
    for (int unsigned s = 0; s < Slots; s++) begin
      if (slot_q == 3'(s)) slot_base = AddrW'(s * SlotWords);
    end
  end

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      state_q <= Idle;
    end else if (cancel_i) begin
      state_q <= Idle;
    end else if (arm_i) begin
      state_q <= Armed;
    end else begin
      unique case (state_q)
        Armed: if (frame_start_i) state_q <= Check;
        Check: begin
          if (frame_abort_i) state_q <= Armed;
          else if (check_q == '0) state_q <= slot_busy_i ? Armed : Write;
        end
        Write: begin
          if (frame_abort_i) state_q <= Armed;
          else if (frame_done_i) state_q <= Finish;
        end
        Finish: if (level == '0) state_q <= Idle;
        default: state_q <= Idle;
      endcase
    end
  end

  always_ff @(posedge clk_i) begin
    if (arm_i) slot_q <= slot_i;
    if (state_q == Armed) begin
      check_q     <= CheckClocks - 2'd1;
      was_valid_q <= slot_valid_i;
      row_q       <= slot_base;
      addr_q      <= slot_base;
    end else begin
      if (check_q != '0) check_q <= check_q - 1'b1;
      if (push) begin
        addr_q <= word_last_i ? row_q + AddrW'(WordsPerRow) : addr_q + 1'b1;
        if (word_last_i) row_q <= row_q + AddrW'(WordsPerRow);
      end
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
  `SLOG_ASSERT(SlogCaptureNoEarlyWord, state_q == Check |-> !word_valid_i)
  `SLOG_ASSERT(SlogCaptureArmWhenFree, arm_i |-> !writing_o)
endmodule : slog_capture_channel
