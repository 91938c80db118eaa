// SPDX-License-Identifier: Apache-2.0
// slog_capture's slots: no word is written to a slot that is marked valid, nor to one that a job still reads; no slot is
// held by both cameras.
//
// A job reads a slot if the slot's valid bit was set in the clock before the job's mark in slot_busy_i appears (slog_fetch).
module slog_rules_capture_slots #(
    parameter int unsigned Slots     = 2,
    parameter int unsigned SlotWords = 4,
    parameter int unsigned AddrW     = 3,
    parameter int unsigned WordsPerRow = 2
) (
    input logic             clk_i,
    input logic             rst_i,
    input logic             cmd_valid_i,
    input logic [7:0]       slot_busy_i,
    input logic [1:0]       frame_start_i,
    input logic [1:0]       frame_done_i,
    input logic [1:0]       frame_abort_i,
    input logic [1:0]       word_valid_i,
    input logic [1:0]       word_last_i,
    input logic             clear_i,
    input logic             wr_valid_o,
    input logic [AddrW-1:0] wr_addr_o,
    input logic [7:0]       slot_valid_o,
    input logic [1:0]       held,
    input logic [1:0][2:0]  slot,
    input logic [1:0]       writing_o,
    input logic             done_o
);
  logic [7:0] valid_q, busy_q, read_q, read;  // read: a job reads the slot
  logic [1:0] frame_q;                        // a frame is under way
  logic [2:0] written;
  logic [2:0] since_q;                        // clocks since the last command, or the reset
  logic [1:0][2:0] between_q;                 // clocks since the camera's last frame began or ended
  assign written = 3'(32'(wr_addr_o) / SlotWords);
  assign read    = slot_busy_i & (read_q | (~busy_q & valid_q));
  always_ff @(posedge clk_i) begin
    valid_q <= rst_i ? '0 : slot_valid_o;
    busy_q  <= rst_i ? '0 : slot_busy_i;
    read_q  <= rst_i ? '0 : read;
    since_q <= (rst_i || cmd_valid_i) ? '0 : (since_q == '1) ? since_q : since_q + 1'b1;
    // slog_axil's accesses are five clocks apart. Without this a channel armed three clocks after a cancel, in the clock
    // of a frame's start, would skip the check.
    if (!rst_i) AssumeCommandsApart : assume (!cmd_valid_i || since_q >= 3'd4);
  end
  // A frame's words fit into a slot: rows of WordsPerRow words at most.
  localparam int unsigned Rows = SlotWords / WordsPerRow;
  logic [1:0][3:0] row_q, column_q;
  for (genvar c = 0; c < 2; c++) begin : g_camera
    always_ff @(posedge clk_i) begin
      between_q[c] <= (rst_i || frame_start_i[c] || frame_done_i[c] || frame_abort_i[c]) ? '0
                      : (between_q[c] == '1) ? between_q[c] : between_q[c] + 1'b1;
      frame_q[c] <= !rst_i && (frame_start_i[c] || (frame_q[c] && !frame_done_i[c] && !frame_abort_i[c]));
      if (frame_start_i[c]) begin
        row_q[c]    <= '0;
        column_q[c] <= '0;
      end else if (word_valid_i[c]) begin
        row_q[c]    <= row_q[c] + 4'(word_last_i[c]);
        column_q[c] <= word_last_i[c] ? '0 : column_q[c] + 1'b1;
      end
      if (!rst_i) begin
        AssumeFits : assume (!word_valid_i[c] || (32'(row_q[c]) < Rows && 32'(column_q[c]) < WordsPerRow));
        AssumeFrame : assume ($onehot0({frame_start_i[c], frame_done_i[c], frame_abort_i[c]})
                              && (frame_q[c] || !(frame_done_i[c] || frame_abort_i[c] || word_valid_i[c]))
                              && !(frame_start_i[c] && (frame_q[c] || between_q[c] < 3'd6)));
      end
    end
  end
  always_ff @(posedge clk_i) begin
    if (!rst_i) begin
      RulesCaptureInvalid : assert (!wr_valid_o || !slot_valid_o[written]);
      RulesCaptureNotRead : assert (!wr_valid_o || !read[written]);
      RulesCaptureApart : assert (held != '1 || slot[0] != slot[1]);
      CoverRead : cover (read[1] && writing_o[0]);
      CoverBoth : cover (writing_o == '1);
      CoverValid : cover (done_o && wr_valid_o);
    end
  end
endmodule : slog_rules_capture_slots

bind slog_capture slog_rules_capture_slots #(.Slots(Slots), .SlotWords(SlotWords), .AddrW(AddrW),
                                                   .WordsPerRow(WordsPerRow)) u_rules_slots (.*);
