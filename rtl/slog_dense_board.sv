// SPDX-License-Identifier: Apache-2.0
// The board with the dense engine instead of the array: two cameras, sign-of-LoG front ends, bit-plane store, dense engine,
// registers. Wiring only.
//
// Registers  : AXI4-Lite, rtl/control/slog_csr.rdl and slog_dense_csr.rdl. Jobs for the array are counted as lost.
// Video      : AXI4-Stream per camera, 8-bit grey, tuser = start of frame, tlast = end of line; one pixel per clock.
// Map        : AXI4-Stream of slog_dense_pkg::map_t, the pixels of a pass in raster order; tuser = first, tlast = last of it.
// Reset      : rst_i is held for 1 clock or more. It reaches the blocks 4 clocks after the pin and leaves them 7 clocks
//              after; transfers in either direction before the first of these are lost, between them none is made. The
//              board starts in reset at power-up.
// Rule       : of a slot into which a capture has written since the slot last held a whole frame the engine reads only words
//              of that capture's frame; so a map is of one frame of each camera, or refused, or ended with DenseLost.
`include "slog_assert.svh"
module slog_dense_board
  import slog_pkg::*;
  import slog_dense_pkg::*;
  import slog_store_pkg::*;
  import slog_cfg_pkg::*;
(
    input  logic                    clk_i,
    input  logic                    rst_i,
    input  logic [AxilAddrW-1:0]    s_axil_awaddr,
    input  logic [2:0]              s_axil_awprot,
    input  logic                    s_axil_awvalid,
    output logic                    s_axil_awready,
    input  logic [31:0]             s_axil_wdata,
    input  logic [3:0]              s_axil_wstrb,
    input  logic                    s_axil_wvalid,
    output logic                    s_axil_wready,
    output logic [1:0]              s_axil_bresp,
    output logic                    s_axil_bvalid,
    input  logic                    s_axil_bready,
    input  logic [AxilAddrW-1:0]    s_axil_araddr,
    input  logic [2:0]              s_axil_arprot,
    input  logic                    s_axil_arvalid,
    output logic                    s_axil_arready,
    output logic [31:0]             s_axil_rdata,
    output logic [1:0]              s_axil_rresp,
    output logic                    s_axil_rvalid,
    input  logic                    s_axil_rready,
    input  logic [Cameras-1:0][7:0] vid_tdata_i,
    input  logic [Cameras-1:0]      vid_tvalid_i,
    output logic [Cameras-1:0]      vid_tready_o,
    input  logic [Cameras-1:0]      vid_tuser_i,
    input  logic [Cameras-1:0]      vid_tlast_i,
    output logic [63:0]             map_tdata_o,
    output logic                    map_tvalid_o,
    input  logic                    map_tready_i,
    output logic                    map_tuser_o,
    output logic                    map_tlast_o,
    output logic                    irq_o
);
  localparam int unsigned AddrW    = $clog2(StoreWords);
  localparam int unsigned OutDepth = 2 ** $clog2(3 * MaxWidth);  // words of maps: three rows, so that none waits

  // Front ends
  logic [Cameras-1:0] hold, stop;
  logic [9:0] width, height;
  logic [Coefs-1:0][CoefBits-1:0] g, g2;
  logic [Cameras-1:0] front_busy, accepted, dropped;
  logic [Cameras-1:0] word_valid, word_last, frame_start, frame_done, frame_abort;
  logic [Cameras-1:0][GroupBits-1:0] word_data;
  // Capture and store
  logic capture_valid, capture_cancel, capture_camera, capture_refused, captured, slots_clear;
  logic [2:0] capture_slot;
  logic [7:0] slot_valid, slot_busy;
  logic [Cameras-1:0] armed, writing;
  progress_t [Cameras-1:0] progress;
  logic wr_valid, rd_valid, peek_valid, peek_ready, peek_done;
  logic [AddrW-1:0] wr_addr, rd_addr, peek_addr;
  logic [GroupBits-1:0] wr_data, rd_data, peek_data;
  // Passes
  logic start, cancel, work, done, row, stall;
  dense_job_t job;
  dense_status_e status;
  // Extension of the registers
  logic ext_req, ext_is_wr, ext_irq;
  logic [AxilAddrW-1:0] ext_addr;
  logic [31:0] ext_data, ext_biten, ext_rd_data;
  // The array's jobs
  logic unused_job_valid, unused_result_ready;
  job_t unused_job;
  logic [9:0] unused_grid_x, unused_grid_y, unused_step_x, unused_step_y;

  axil_req_t axil_req;
  axil_rsp_t axil_rsp;
  assign axil_req = '{
      awaddr: s_axil_awaddr, awprot: s_axil_awprot, awvalid: s_axil_awvalid,
      wdata: s_axil_wdata, wstrb: s_axil_wstrb, wvalid: s_axil_wvalid, bready: s_axil_bready,
      araddr: s_axil_araddr, arprot: s_axil_arprot, arvalid: s_axil_arvalid, rready: s_axil_rready
  };
  assign s_axil_awready = axil_rsp.awready;
  assign s_axil_wready  = axil_rsp.wready;
  assign s_axil_bresp   = axil_rsp.bresp;
  assign s_axil_bvalid  = axil_rsp.bvalid;
  assign s_axil_arready = axil_rsp.arready;
  assign s_axil_rdata   = axil_rsp.rdata;
  assign s_axil_rresp   = axil_rsp.rresp;
  assign s_axil_rvalid  = axil_rsp.rvalid;

  logic rst;
  slog_reset u_reset (.clk_i, .rst_i, .rst_o(rst));

  slog_control #(
      .Extension(1'b1)
  ) u_control (
      .clk_i,
      .rst_i           (rst),
      .axil_i          (axil_req),
      .axil_o          (axil_rsp),
      .hold_o          (hold),
      .abort_o         (stop),
      .width_o         (width),
      .height_o        (height),
      .g_o             (g),
      .g2_o            (g2),
      .active_i        (front_busy),
      .accepted_i      (accepted),
      .dropped_i       (dropped),
      .capture_valid_o (capture_valid),
      .capture_cancel_o(capture_cancel),
      .capture_camera_o(capture_camera),
      .capture_slot_o  (capture_slot),
      .slots_clear_o   (slots_clear),
      .slot_valid_i    (slot_valid),
      .armed_i         (armed),
      .writing_i       (writing),
      .refused_i       (capture_refused),
      .captured_i      (captured),
      .job_valid_o     (unused_job_valid),
      .job_ready_i     (1'b0),
      .job_o           (unused_job),
      .grid_x_o        (unused_grid_x),
      .grid_y_o        (unused_grid_y),
      .step_x_o        (unused_step_x),
      .step_y_o        (unused_step_y),
      .job_level_i     ('0),
      .job_busy_i      (1'b0),
      .result_valid_i  (1'b0),
      .result_ready_o  (unused_result_ready),
      .result_i        ('0),
      .result_level_i  ('0),
      .work_i          (work),
      .score_i         (1'b0),
      .peek_valid_o    (peek_valid),
      .peek_ready_i    (peek_ready),
      .peek_addr_o     (peek_addr),
      .peek_done_i     (peek_done),
      .peek_data_i     (peek_data),
      .ext_req_o       (ext_req),
      .ext_is_wr_o     (ext_is_wr),
      .ext_addr_o      (ext_addr),
      .ext_data_o      (ext_data),
      .ext_biten_o     (ext_biten),
      .ext_rd_data_i   (ext_rd_data),
      .ext_irq_i       (ext_irq),
      .irq_o
  );

  slog_dense_control #(
      .Offsets  (DenseOffsets),
      .Lanes    (DenseLanes),
      .MaxWindow(DenseWindow),
      .Sizes    (DenseSizes)
  ) u_dense_control (
      .clk_i,
      .rst_i    (rst),
      .req_i    (ext_req),
      .is_wr_i  (ext_is_wr),
      .addr_i   (ext_addr),
      .data_i   (ext_data),
      .biten_i  (ext_biten),
      .rd_data_o(ext_rd_data),
      .irq_o    (ext_irq),
      .start_o  (start),
      .cancel_o (cancel),
      .job_o    (job),
      .busy_i   (work),
      .done_i   (done),
      .status_i (status),
      .row_i    (row),
      .stall_i  (stall)
  );

  // hold keeps a front end's clock running while its settings change.
  for (genvar c = 0; c < Cameras; c++) begin : g_camera
    logic clk;
    slog_clock_gate u_gate (
        .clk_i,
        .rst_i   (rst),
        .active_i(vid_tvalid_i[c] || front_busy[c] || hold[c] || stop[c]),
        .clk_o   (clk)
    );
    slog_frontend #(
        .MaxWidth(MaxWidth),
        .Radius(Radius),
        .GroupBits(GroupBits)
    ) u_frontend (
        .clk_i        (clk),
        .rst_i        (rst),
        .tdata_i      (vid_tdata_i[c]),
        .tvalid_i     (vid_tvalid_i[c]),
        .tready_o     (vid_tready_o[c]),
        .tuser_i      (vid_tuser_i[c]),
        .tlast_i      (vid_tlast_i[c]),
        .width_i      (width),
        .height_i     (height),
        .g_i          (g),
        .g2_i         (g2),
        .hold_i       (hold[c]),
        .abort_i      (stop[c]),
        .busy_o       (front_busy[c]),
        .word_valid_o (word_valid[c]),
        .word_data_o  (word_data[c]),
        .word_last_o  (word_last[c]),
        .frame_start_o(frame_start[c]),
        .frame_done_o (frame_done[c]),
        .frame_abort_o(frame_abort[c]),
        .accepted_o   (accepted[c]),
        .dropped_o    (dropped[c])
    );
  end

  // All activity that follows a word, a frame start or a frame end is over within Linger clocks.
  logic store_clk;
  slog_clock_gate #(
      .Linger(20)
  ) u_store_gate (
      .clk_i,
      .rst_i   (rst),
      .active_i((word_valid | frame_start | frame_done | frame_abort) != '0 || capture_valid || slots_clear || work ||
                peek_valid || peek_done || !peek_ready),
      .clk_o   (store_clk)
  );

  slog_capture #(
      .Cameras(Cameras),
      .GroupBits(GroupBits),
      .Slots(Slots),
      .SlotWords(SlotWords),
      .WordsPerRow(WordsPerRow),
      .Progress(1'b1)
  ) u_capture (
      .clk_i        (store_clk),
      .rst_i        (rst),
      .cmd_valid_i  (capture_valid),
      .cmd_cancel_i (capture_cancel),
      .cmd_camera_i (capture_camera),
      .cmd_slot_i   (capture_slot),
      .clear_i      (slots_clear),
      .slot_busy_i  (slot_busy),
      .word_valid_i (word_valid),
      .word_data_i  (word_data),
      .word_last_i  (word_last),
      .frame_start_i(frame_start),
      .frame_done_i (frame_done),
      .frame_abort_i(frame_abort),
      .wr_valid_o   (wr_valid),
      .wr_addr_o    (wr_addr),
      .wr_data_o    (wr_data),
      .slot_valid_o (slot_valid),
      .armed_o      (armed),
      .writing_o    (writing),
      .refused_o    (capture_refused),
      .done_o       (captured),
      .progress_o   (progress)
  );

  slog_store #(
      .Width(GroupBits),
      .Words(StoreWords)
  ) u_store (
      .clk_i       (store_clk),
      .rst_i       (rst),
      .wr_valid_i  (wr_valid),
      .wr_addr_i   (wr_addr),
      .wr_data_i   (wr_data),
      .rd_valid_i  (rd_valid),
      .rd_addr_i   (rd_addr),
      .rd_data_o   (rd_data),
      .peek_valid_i(peek_valid),
      .peek_ready_o(peek_ready),
      .peek_addr_i (peek_addr),
      .peek_done_o (peek_done),
      .peek_data_o (peek_data)
  );

  logic dense_clk;
  slog_clock_gate #(
      .Linger(64)
  ) u_dense_gate (
      .clk_i,
      .rst_i   (rst),
      .active_i(start || work || map_tvalid_o),
      .clk_o   (dense_clk)
  );

  slog_dense #(
      .Width      (GroupBits),
      .MaxWidth   (MaxWidth),
      .MaxHeight  (MaxHeight),
      .WordsPerRow(WordsPerRow),
      .Slots      (Slots),
      .Offsets    (DenseOffsets),
      .Lanes      (DenseLanes),
      .MaxWindow  (DenseWindow),
      .Sizes      (DenseSizes),
      .OutDepth   (OutDepth),
      .Cameras    (Cameras)
  ) u_dense (
      .clk_i         (dense_clk),
      .rst_i         (rst),
      .start_i       (start),
      .job_i         (job),
      .cancel_i      (cancel),
      .image_width_i (width),
      .image_height_i(height),
      .slot_valid_i  (slot_valid),
      .progress_i    (progress),
      .clear_i       (slots_clear),
      .slot_busy_o   (slot_busy),
      .rd_valid_o    (rd_valid),
      .rd_addr_o     (rd_addr),
      .rd_data_i     (rd_data),
      .map_tvalid_o,
      .map_tready_i,
      .map_tdata_o,
      .map_tuser_o,
      .map_tlast_o,
      .busy_o        (work),
      .done_o        (done),
      .status_o      (status),
      .row_o         (row),
      .stall_o       (stall)
  );

`ifndef SYNTHESIS
  // Slots partly written: from the first word of a capture until the slot is valid again. A frame's words are written with
  // ascending addresses, so those from end_q on are of another frame; end_q is the word after the last one that may be read.
  logic [7:0] partial_q, partial;
  logic [7:0][AddrW:0] end_q, end_q2;
  logic [2:0] read_slot;
  assign partial   = (partial_q | (8'(wr_valid) << wr_addr / AddrW'(SlotWords))) & ~slot_valid;
  assign read_slot = 3'(rd_addr / AddrW'(SlotWords));
  always_ff @(posedge clk_i) begin
    partial_q <= rst ? '0 : partial;
    end_q2    <= end_q;
    if (wr_valid) end_q[3'(wr_addr/AddrW'(SlotWords))] <= (AddrW + 1)'(wr_addr) + 1'b1;
  end
  `SLOG_ASSERT(SlogDenseBoardOneFrame, rst || !rd_valid || !partial[read_slot] || (partial_q[read_slot] &&
               (AddrW + 1)'(rd_addr) < end_q2[read_slot] && (AddrW + 1)'(rd_addr) < end_q[read_slot]))
`endif
endmodule : slog_dense_board
