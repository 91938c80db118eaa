// SPDX-License-Identifier: Apache-2.0
// Captures: assigns each camera's next frame to a slot, tracks which slots hold a frame, and drives the store's write port.
//
// A command arms its camera with a slot, or cancels the camera's request. Arming is refused for a slot this board
// does not have, for a slot the other camera holds, and for a camera that is writing. An armed request whose frame has not
// started is replaced by a new one.
// A cancelled frame, an aborted frame and clear_i leave their slots invalid.
//
// The word queues (slog_capture_slice) lie near the store, the channels' control near the registers: Hops pipeline registers
// lie between them.
//
// Latency    : word to store write 5 + Hops clocks, more when both cameras deliver words at once (camera 0 has priority); the
//              slot is valid 5 + Hops clocks after frame_done_i (Hops = 2). A command takes effect after 2
//              clocks, when armed_o and refused_o show its outcome.
// Throughput : one word per clock into the store.
// Progress   : with Progress, progress_o tells of each camera how far its slot is written: see progress_t. A word of a row that it counts in
//              clock t is written by wr_valid_o of clock t + 2 at the latest.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_capture
  import slog_store_pkg::*;
#(
    parameter  int unsigned Cameras     = 2,
    parameter  int unsigned GroupBits   = 64,
    parameter  int unsigned Slots       = 6,
    parameter  int unsigned SlotWords   = 4800,
    parameter  int unsigned WordsPerRow = 10,
    parameter  bit          Progress    = 1'b0,  // progress_o is used
    localparam int unsigned AddrW       = $clog2(Slots * SlotWords)
) (
    input  logic                              clk_i,
    input  logic                              rst_i,
    input  logic                              cmd_valid_i,
    input  logic                              cmd_cancel_i,
    input  logic                              cmd_camera_i,
    input  logic [2:0]                        cmd_slot_i,
    input  logic                              clear_i,         // every slot becomes invalid
    input  logic [7:0]                        slot_busy_i,     // slots that the correlator is reading
    input  logic [Cameras-1:0]                word_valid_i,
    input  logic [Cameras-1:0][GroupBits-1:0] word_data_i,
    input  logic [Cameras-1:0]                word_last_i,
    input  logic [Cameras-1:0]                frame_start_i,
    input  logic [Cameras-1:0]                frame_done_i,
    input  logic [Cameras-1:0]                frame_abort_i,
    output logic                              wr_valid_o,
    output logic [AddrW-1:0]                  wr_addr_o,
    output logic [GroupBits-1:0]              wr_data_o,
    output logic [7:0]                        slot_valid_o,
    output logic [Cameras-1:0]                armed_o,
    output logic [Cameras-1:0]                writing_o,
    output logic                              refused_o,       // the last command was refused
    output logic                              done_o,          // pulse: a slot became valid
    output progress_t [Cameras-1:0]           progress_o
);
  localparam int unsigned Depth  = 4;  // of each camera's queue
  localparam int unsigned WordW  = AddrW + GroupBits;
  localparam int unsigned SliceW = 16;
  localparam int unsigned Hops   = 2;

  logic [Cameras-1:0] clear, set, finish, push, empty, pop;
  logic [Cameras-1:0][2:0] slot;
  logic [Cameras-1:0][7:0] slot_mask;
  logic [Cameras-1:0] push_q[Hops], empty_q[Hops];
  logic [Cameras-1:0][AddrW-1:0] far_addr;
  logic [Cameras-1:0][GroupBits-1:0] far_data;
  logic [7:0] slot_valid_d, slot_valid_q;
  logic refused, refused_q, done_q;
  logic [Hops+1:0] wr_valid_q;  // bit n: a word waited n + 1 clocks ago
  logic [WordW-1:0] word;

  // Input registers: the command's source lies far away.
  logic come_valid_q, come_cancel_q, come_camera_q;
  logic [2:0] come_slot_q;
  always_ff @(posedge clk_i) begin
    come_valid_q  <= cmd_valid_i && !rst_i;
    come_cancel_q <= cmd_cancel_i;
    come_camera_q <= cmd_camera_i;
    come_slot_q   <= cmd_slot_i;
  end

  // The command one clock later, and whether the other camera holds its slot. ask_q is 0 if the board has no such slot.
  logic [Cameras-1:0] ask_q, cancel_q, ask, arm, held, free, same_q;
  logic [2:0] cmd_slot_q;
  logic cmd_valid_q, cmd_arms_q;
  logic [7:0] slot_busy_q;
  always_ff @(posedge clk_i) begin
    slot_busy_q <= slot_busy_i;
    cmd_slot_q <= come_slot_q;
    cmd_arms_q <= !come_cancel_q;
    for (int unsigned c = 0; c < Cameras; c++) begin
      same_q[c] <= 1'b0;
      for (int unsigned o = 0; o < Cameras; o++) begin
        if (o != c) same_q[c] <= arm[o] ? cmd_slot_q == come_slot_q : slot[o] == come_slot_q;
      end
    end
    if (rst_i) begin
      cmd_valid_q <= 1'b0;
      ask_q       <= '0;
      cancel_q    <= '0;
    end else begin
      cmd_valid_q <= come_valid_q;
      for (int unsigned c = 0; c < Cameras; c++) begin
        ask_q[c]    <= come_valid_q && !come_cancel_q && 32'(come_camera_q) == c && 4'(come_slot_q) < 4'(Slots);
        cancel_q[c] <= come_valid_q && come_cancel_q && 32'(come_camera_q) == c;
      end
    end
  end

  always_comb begin
    ask = ask_q;
    arm = ask_q & ~writing_o;
    for (int unsigned c = 0; c < Cameras; c++) begin
      for (int unsigned o = 0; o < Cameras; o++) begin
        if (o != c && held[o] && same_q[c]) ask[c] = 1'b0;
        if (o != c && !free[o] && same_q[c]) arm[c] = 1'b0;
      end
    end
  end

  assign refused = cmd_valid_q ? cmd_arms_q && arm == '0 : refused_q;

  for (genvar c = 0; c < Cameras; c++) begin : g_channel
    logic [AddrW-1:0] addr, addr_q[Hops];
    logic [GroupBits-1:0] data, data_q[Hops];
    always_ff @(posedge clk_i) begin
      addr_q[0] <= addr;
      data_q[0] <= data;
      for (int unsigned n = 1; n < Hops; n++) begin
        addr_q[n] <= addr_q[n-1];
        data_q[n] <= data_q[n-1];
      end
    end
    assign far_addr[c] = addr_q[Hops-1];
    assign far_data[c] = data_q[Hops-1];
    slog_capture_channel #(
        .GroupBits(GroupBits),
        .Slots(Slots),
        .SlotWords(SlotWords),
        .WordsPerRow(WordsPerRow),
        .Depth(Depth),
        .Hops(Hops),
        .Progress(Progress)
    ) u_channel (
        .clk_i,
        .rst_i,
        .ask_i        (ask[c]),
        .arm_i        (arm[c]),
        .cancel_i     (cancel_q[c]),
        .slot_i       (cmd_slot_q),
        .slot_busy_i  ((slot_busy_q & slot_mask[c]) != '0),
        .slot_valid_i ((slot_valid_q & slot_mask[c]) != '0),
        .word_valid_i (word_valid_i[c]),
        .word_data_i  (word_data_i[c]),
        .word_last_i  (word_last_i[c]),
        .frame_start_i(frame_start_i[c]),
        .frame_done_i (frame_done_i[c]),
        .frame_abort_i(frame_abort_i[c]),
        .push_o       (push[c]),
        .addr_o       (addr),
        .data_o       (data),
        .empty_o      (empty[c]),
        .pop_i        (pop[c]),
        .slot_o       (slot[c]),
        .slot_mask_o  (slot_mask[c]),
        .armed_o      (armed_o[c]),
        .held_o       (held[c]),
        .free_o       (free[c]),
        .writing_o    (writing_o[c]),
        .clear_o      (clear[c]),
        .set_o        (set[c]),
        .finish_o     (finish[c]),
        .progress_o   (progress_o[c])
    );
  end

  always_comb begin
    slot_valid_d = slot_valid_q;
    for (int unsigned c = 0; c < Cameras; c++) begin
      if (clear[c]) slot_valid_d &= ~slot_mask[c];
      if (set[c]) slot_valid_d |= slot_mask[c];
    end
    if (clear_i) slot_valid_d = '0;
  end

  assign pop[0] = !empty[0];
  if (Cameras > 1) begin : g_second
    assign pop[1] = !empty[1] && empty[0];
  end

  for (genvar s = 0; s < (WordW + SliceW - 1) / SliceW; s++) begin : g_slice
    localparam int unsigned Low  = s * SliceW;
    localparam int unsigned Bits = (WordW - Low < SliceW) ? WordW - Low : SliceW;
    logic [Cameras-1:0][Bits-1:0] part;
    for (genvar c = 0; c < Cameras; c++) begin : g_part
      assign part[c] = Bits'({far_addr[c], far_data[c]} >> Low);
    end
    slog_capture_slice #(
        .Cameras(Cameras),
        .Width  (Bits),
        .Depth  (Depth)
    ) u_slice (
        .clk_i,
        .rst_i,
        .push_i (push_q[Hops-1]),
        .data_i (part),
        .empty_i(empty_q[Hops-1]),
        .data_o (word[Low+:Bits])
    );
  end

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      slot_valid_q <= '0;
      refused_q    <= 1'b0;
      done_q       <= 1'b0;
      wr_valid_q   <= '0;
      for (int unsigned n = 0; n < Hops; n++) begin
        push_q[n]  <= '0;
        empty_q[n] <= '1;
      end
    end else begin
      slot_valid_q <= slot_valid_d;
      refused_q    <= refused;
      done_q       <= finish != '0;
      wr_valid_q   <= {wr_valid_q[Hops:0], empty != '1};
      for (int unsigned n = 0; n < Hops; n++) begin
        push_q[n]  <= (n == 0) ? push : push_q[n-1];
        empty_q[n] <= (n == 0) ? empty : empty_q[n-1];
      end
    end
  end

  assign wr_valid_o   = wr_valid_q[Hops+1];
  assign wr_addr_o    = word[WordW-1:GroupBits];
  assign wr_data_o    = word[GroupBits-1:0];
  assign slot_valid_o = slot_valid_q;
  assign refused_o    = refused;
  assign done_o       = done_q;

  `SLOG_ASSERT_INIT(SlogCaptureSlots, Slots <= 8)
  `SLOG_ASSERT_INIT(SlogCaptureCameras, Cameras <= 2)
endmodule : slog_capture
