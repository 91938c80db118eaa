// SPDX-License-Identifier: Apache-2.0
// Registers and the blocks that only they use: coefficient bank, peek port, counters, interrupt. Wiring, and the translation
// of register fields to the blocks' ports.
//
// Latency    : a command reaches the blocks 9 clocks after its address and data were accepted, result.pop after 11. Values
//              read are one clock old, result.head.valid two, counts three, counts of results four. irq_o follows a result
//              by 2 clocks, captures and drops by 3, a lost submit by 4.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_control
  import slog_pkg::*;
  import slog_cfg_pkg::*;
#(
    parameter  bit          Extension = 1'b0,
    localparam int unsigned AddrW     = $clog2(StoreWords)
) (
    input  logic                           clk_i,
    input  logic                           rst_i,
    input  axil_req_t                      axil_i,
    output axil_rsp_t                      axil_o,
    // front ends
    output logic [Cameras-1:0]             hold_o,
    output logic [Cameras-1:0]             abort_o,         // pulses: drop the frame that the camera is sending
    output logic [9:0]                     width_o,
    output logic [9:0]                     height_o,
    output logic [Coefs-1:0][CoefBits-1:0] g_o,
    output logic [Coefs-1:0][CoefBits-1:0] g2_o,
    input  logic [Cameras-1:0]             active_i,
    input  logic [Cameras-1:0]             accepted_i,
    input  logic [Cameras-1:0]             dropped_i,
    // capture
    output logic                           capture_valid_o,
    output logic                           capture_cancel_o,
    output logic                           capture_camera_o,
    output logic [2:0]                     capture_slot_o,
    output logic                           slots_clear_o,
    input  logic [7:0]                     slot_valid_i,
    input  logic [Cameras-1:0]             armed_i,
    input  logic [Cameras-1:0]             writing_i,
    input  logic                           refused_i,
    input  logic                           captured_i,
    // jobs
    output logic                           job_valid_o,
    input  logic                           job_ready_i,
    output job_t                           job_o,
    output logic [9:0]                     grid_x_o,
    output logic [9:0]                     grid_y_o,
    output logic [9:0]                     step_x_o,
    output logic [9:0]                     step_y_o,
    input  logic [15:0]                    job_level_i,
    input  logic                           job_busy_i,
    // results
    input  logic                           result_valid_i,
    output logic                           result_ready_o,
    input  result_t                        result_i,
    input  logic [15:0]                    result_level_i,
    input  logic                           work_i,           // a job is being processed
    input  logic                           score_i,          // a score was computed
    // plane read-back
    output logic                           peek_valid_o,
    input  logic                           peek_ready_i,
    output logic [AddrW-1:0]               peek_addr_o,
    input  logic                           peek_done_i,
    input  logic [GroupBits-1:0]           peek_data_i,
    // extension
    output logic                           ext_req_o,        // pulse
    output logic                           ext_is_wr_o,
    output logic [AxilAddrW-1:0]           ext_addr_o,
    output logic [31:0]                    ext_data_o,
    output logic [31:0]                    ext_biten_o,
    input  logic [31:0]                    ext_rd_data_i,
    input  logic                           ext_irq_i,
    output logic                           irq_o
);
  // Cameras that the register map has counters for.
  localparam int unsigned MaxCameras = 2;
  // The one register whose reads wait: peek_data.
  localparam logic [AxilAddrW-1:0] PeekData = 8'h84;
  localparam int unsigned Events = 6 + 2 * MaxCameras;

  slog_csr_pkg::slog_csr__in_t status, hwif_in;
  logic clk;
  slog_csr_pkg::slog_csr__out_t hwif_out;
  logic [Events-1:0] events, events_q;
  logic [Events-1:0][31:0] counts;
  logic overflow, taken, filter_busy, size_error, irq_q;
  logic seen_q;            // a result is available
  logic none_q;            // !seen_q, a copy: it clears the result's registers
  logic [2:0] outcome_q;   // the result's status
  logic pop_q, pop_q2, pop_q3;  // the front result is popped: in the next clock, in this, in the clock before
  logic [31:0] peek_data;
  logic peek_ready, peek_wait_q;
  logic bus_busy, req, req_is_wr, wr_ack, rd_ack, stall_wr, stall_rd, rd_err, wr_err;
  logic [AxilAddrW-1:0] req_addr;
  logic [31:0] req_data, req_biten, rd_data;

  // The registers, the coefficient bank and the peek port are idle without an access, an event, a commit or a peek.
  slog_clock_gate #(
      .Linger(16)
  ) u_gate (
      .clk_i,
      .rst_i,
      .active_i(axil_i.awvalid || axil_i.wvalid || axil_i.arvalid || axil_i.bready || axil_i.rready || bus_busy ||
                captured_i || dropped_i != '0 || filter_busy || peek_valid_o || peek_done_i),
      .clk_o   (clk)
  );

  // The registers show values one clock late; peek_wait_q is delayed alike, so a read never passes the data it waits for.
  always_ff @(posedge clk) begin
    hwif_in     <= status;
    peek_wait_q <= !peek_ready || hwif_out.peek_address.go.value;
    if (rst_i) begin
      hwif_in.irq_status.capture.next  <= 1'b0;
      hwif_in.irq_status.drop.next     <= 1'b0;
      hwif_in.irq_status.overflow.next <= 1'b0;
    end
  end

  slog_axil #(
      .AddrW   (AxilAddrW),
      .WaitAddr(PeekData)
  ) u_axil (
      .clk_i      (clk),
      .rst_i,
      .awaddr_i   (axil_i.awaddr),
      .awvalid_i  (axil_i.awvalid),
      .awready_o  (axil_o.awready),
      .wdata_i    (axil_i.wdata),
      .wstrb_i    (axil_i.wstrb),
      .wvalid_i   (axil_i.wvalid),
      .wready_o   (axil_o.wready),
      .bvalid_o   (axil_o.bvalid),
      .bready_i   (axil_i.bready),
      .araddr_i   (axil_i.araddr),
      .arvalid_i  (axil_i.arvalid),
      .arready_o  (axil_o.arready),
      .rdata_o    (axil_o.rdata),
      .rvalid_o   (axil_o.rvalid),
      .rready_i   (axil_i.rready),
      .busy_o     (bus_busy),
      .wait_i     (peek_wait_q),
      .req_o      (req),
      .req_is_wr_o(req_is_wr),
      .req_addr_o (req_addr),
      .req_data_o (req_data),
      .req_biten_o(req_biten),
      .wr_ack_i   (wr_ack),
      .rd_ack_i   (rd_ack),
      .rd_data_i  (rd_data | (ext_rd_data_i & {32{Extension}}))
  );
  // Every address is answered: bresp and rresp are always OKAY. The protection bits are ignored.
  logic unused_prot;
  assign unused_prot = ^{axil_i.awprot, axil_i.arprot};
  assign axil_o.bresp = 2'b00;
  assign axil_o.rresp = 2'b00;

  slog_csr u_csr (
      .clk,
      .rst                 (rst_i),
      .s_cpuif_req         (req),
      .s_cpuif_req_is_wr   (req_is_wr),
      .s_cpuif_addr        (req_addr),
      .s_cpuif_wr_data     (req_data),
      .s_cpuif_wr_biten    (req_biten),
      .s_cpuif_req_stall_wr(stall_wr),
      .s_cpuif_req_stall_rd(stall_rd),
      .s_cpuif_rd_ack      (rd_ack),
      .s_cpuif_rd_err      (rd_err),
      .s_cpuif_rd_data     (rd_data),
      .s_cpuif_wr_ack      (wr_ack),
      .s_cpuif_wr_err      (wr_err),
      .hwif_in,
      .hwif_out
  );

  assign ext_req_o   = req;
  assign ext_is_wr_o = req_is_wr;
  assign ext_addr_o  = req_addr;
  assign ext_data_o  = req_data;
  assign ext_biten_o = req_biten;

  slog_filter_bank #(
      .Cameras(Cameras),
      .Coefs(Coefs),
      .CoefBits(CoefBits),
      .MinImage(MinImage),
      .MaxWidth(MaxWidth),
      .MaxHeight(MaxHeight)
  ) u_filter_bank (
      .clk_i(clk),
      .rst_i,
      .coef_valid_i  (hwif_out.coef.go.value),
      .coef_second_i (hwif_out.coef.second.value),
      .coef_index_i  (hwif_out.coef.index.value),
      .coef_value_i  (hwif_out.coef.value.value),
      .commit_i      (hwif_out.filter.go.value),
      .width_i       (hwif_out.image_size.width.value),
      .height_i      (hwif_out.image_size.height.value),
      .active_i      (active_i | writing_i),
      .hold_o,
      .busy_o        (filter_busy),
      .size_error_o  (size_error),
      .size_changed_o(slots_clear_o),
      .width_o,
      .height_o,
      .g_o,
      .g2_o
  );

  slog_peek #(
      .GroupBits(GroupBits),
      .StoreWords(StoreWords)
  ) u_peek (
      .clk_i(clk),
      .rst_i,
      .go_i     (hwif_out.peek_address.go.value),
      .address_i(hwif_out.peek_address.word.value),
      .take_i   (hwif_out.peek_data.value.swacc),
      .ready_o  (peek_ready),
      .data_o   (peek_data),
      .peek_valid_o,
      .peek_ready_i,
      .peek_addr_o,
      .peek_done_i,
      .peek_data_i
  );

  slog_counters #(
      .Events(Events)
  ) u_counters (
      .clk_i,
      .rst_i,
      .event_i(events_q),
      .count_o(counts)
  );

  // Commands
  assign abort_o          = Cameras'({hwif_out.filter.abort_1.value, hwif_out.filter.abort_0.value});
  assign capture_valid_o  = hwif_out.capture.go.value;
  assign capture_cancel_o = hwif_out.capture.cancel.value;
  assign capture_camera_o = hwif_out.capture.camera.value;
  assign capture_slot_o   = hwif_out.capture.slot.value;

  assign job_valid_o = hwif_out.job.submit.go.value;
  assign overflow    = job_valid_o && !job_ready_i;
  assign job_o = '{
      tag: hwif_out.job.submit.tag.value,
      surface: hwif_out.job.submit.surface.value,
      tpl_slot: hwif_out.job.tpl.slot.value,
      tpl_x: hwif_out.job.tpl.x.value,
      tpl_y: hwif_out.job.tpl.y.value,
      width: hwif_out.job.window.width.value,
      height: hwif_out.job.window.height.value,
      search_slot: hwif_out.job.search.slot.value,
      search_x: hwif_out.job.search.x.value,
      search_y: hwif_out.job.search.y.value,
      offsets_x: hwif_out.job.offsets.across.value,
      offsets_y: hwif_out.job.offsets.down.value
  };
  assign grid_x_o       = hwif_out.job.grid.across.value;
  assign grid_y_o       = hwif_out.job.grid.down.value;
  assign step_x_o       = hwif_out.job.step.x.value;
  assign step_y_o       = hwif_out.job.step.y.value;
  assign result_ready_o = pop_q2;
  always_ff @(posedge clk) begin
    if (rst_i) begin
      pop_q  <= 1'b0;
      pop_q2 <= 1'b0;
      pop_q3 <= 1'b0;
    end else begin
      pop_q  <= hwif_out.result.pop.go.value;
      pop_q2 <= pop_q;
      pop_q3 <= pop_q2;
    end
  end

  // The result queue lies far from the registers. An access takes longer than these registers delay the effect of a pop.
  always_ff @(posedge clk_i) begin
    seen_q    <= result_valid_i;
    none_q    <= !result_valid_i;
    outcome_q <= result_i.status;
  end

  // Status
  assign status.build_image.max_width.next       = 10'(MaxWidth);
  assign status.build_image.max_height.next      = 10'(MaxHeight);
  assign status.build_filter.min_image.next      = 10'(MinImage);
  assign status.build_filter.radius.next         = 5'(Radius);
  assign status.build_filter.fraction.next       = 5'(CoefFraction);
  assign status.build_window.min_window.next     = 8'(MinWindow);
  assign status.build_window.max_window.next     = 8'(MaxWindow);
  assign status.build_window.group_bits.next     = 8'(GroupBits);
  assign status.build_window.words_per_row.next  = 8'(WordsPerRow);
  assign status.build_board.cameras.next         = 4'(Cameras);
  assign status.build_board.slots.next           = 4'(Slots);
  assign status.build_board.lanes.next           = 8'(Lanes);
  assign status.build_board.surface_depth.next   = 16'(SurfaceDepth);
  assign status.build_queue.job_depth.next       = 16'(JobDepth);
  assign status.build_queue.result_depth.next    = 16'(ResultDepth);
  assign status.image_active.width.next          = width_o;
  assign status.image_active.height.next         = height_o;
  assign status.filter.busy.next                 = filter_busy;
  assign status.filter.size_error.next           = size_error;
  assign status.filter.active.next               = 2'(active_i);
  assign status.slot_status.valid.next           = slot_valid_i;
  assign status.slot_status.armed.next           = 2'(armed_i);
  assign status.slot_status.writing.next         = 2'(writing_i);
  assign status.slot_status.refused.next         = refused_i;
  assign status.job.status.waiting.next          = job_level_i;
  assign status.job.status.ready.next            = job_ready_i;
  assign status.job.status.busy.next             = job_busy_i;
  assign status.result.pop.waiting.next          = result_level_i;
  assign status.result.head.tag.next             = none_q ? '0 : result_i.tag;
  assign status.result.head.status.next          = none_q ? '0 : result_i.status;
  assign status.result.head.valid.next           = seen_q;
  assign status.result.best.x.next               = result_i.best_x;
  assign status.result.best.y.next               = result_i.best_y;
  assign status.result.scores.score.next         = result_i.score;
  assign status.result.scores.runner_up.next     = result_i.runner_up;
  for (genvar k = 0; k < 4; k++) begin : g_neighbour
    assign status.result.neighbour[k].even.next = result_i.neighbour[2*k];
    assign status.result.neighbour[k].odd.next  = result_i.neighbour[2*k+1];
  end
  assign status.peek_data.value.next             = peek_data;
  assign status.irq_status.result.next           = seen_q;
  assign status.irq_status.capture.next          = captured_i;
  assign status.irq_status.drop.next             = dropped_i != '0;
  assign status.irq_status.overflow.next         = events_q[5];

  // Counters
  assign taken = seen_q && pop_q3;
  assign events = {
      MaxCameras'(dropped_i), MaxCameras'(accepted_i), overflow, taken && outcome_q != StatusOk,
      taken && outcome_q == StatusOk, score_i, work_i, 1'b1
  };
  always_ff @(posedge clk_i) begin
    if (rst_i) events_q <= '0;
    else events_q <= events;
  end
  assign status.counter.clocks.value.next    = counts[0];
  assign status.counter.busy.value.next      = counts[1];
  assign status.counter.scores.value.next    = counts[2];
  assign status.counter.jobs.value.next      = counts[3];
  assign status.counter.refused.value.next   = counts[4];
  assign status.counter.overflows.value.next = counts[5];
  for (genvar c = 0; c < MaxCameras; c++) begin : g_camera
    assign status.counter.frames[c].value.next = counts[6+c];
    assign status.counter.drops[c].value.next  = counts[6+MaxCameras+c];
  end

  // Interrupt
  always_ff @(posedge clk_i) begin
    if (rst_i) irq_q <= 1'b0;
    else
      irq_q <= (seen_q && hwif_out.irq_enable.result.value) ||
               (hwif_out.irq_status.capture.value && hwif_out.irq_enable.capture.value) ||
               (hwif_out.irq_status.drop.value && hwif_out.irq_enable.drop.value) ||
               (hwif_out.irq_status.overflow.value && hwif_out.irq_enable.overflow.value) ||
               (Extension && ext_irq_i);
  end
  assign irq_o = irq_q;

  `SLOG_ASSERT_INIT(SlogControlAddressWidth, AxilAddrW == slog_csr_pkg::SLOG_CSR_MIN_ADDR_WIDTH)
  `SLOG_ASSERT_NO_RESET(SlogControlCopies, none_q == !seen_q)
  // One access at a time, so none is stalled; PeekData is the address of peek_data in the register map.
  `SLOG_ASSERT(SlogControlNoStall, !(req && (req_is_wr ? stall_wr : stall_rd)) && !rd_err && !wr_err)
  // A reset discards the requests that the register block has not decoded.
  `SLOG_PAST(past_rst, rst_i)
  `SLOG_PAST(past_rst2, past_rst)
  `SLOG_PAST(past_read, req && !req_is_wr && !rst_i)
  `SLOG_PAST(past_read2, past_read)
  `SLOG_PAST(past_read3, past_read2)
  `SLOG_ASSERT(SlogControlPeekAddress, !past_read3 || past_rst || past_rst2
                                       || hwif_out.peek_data.value.swacc == (req_addr == PeekData))
endmodule : slog_control
