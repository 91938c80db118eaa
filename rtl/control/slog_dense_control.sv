// SPDX-License-Identifier: Apache-2.0
// Registers of the dense engine, an extension of slog_control: the pass that they describe, counters, interrupt.
//
// The pass takes over job_o when it starts, so the host may write the registers of the next one while it goes on.
//
// Latency    : start_o 5 clocks after req_i, cancel_o 4; rd_data_o 6, when slog_csr's comes. irq_o follows done_i by 3
//              clocks. Values read are one clock old, counts three.
// Rules      : requests as slog_axil makes them, 5 clocks apart or more. busy_i is high within 4 clocks of start_o, or the
//              pass is over by then.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_dense_control
  import slog_pkg::*;
  import slog_dense_pkg::*;
#(
    parameter int unsigned Offsets   = 128,
    parameter int unsigned Lanes     = 8,
    parameter int unsigned MaxWindow = 32,
    parameter int unsigned Sizes     = 3
) (
    input  logic                 clk_i,
    input  logic                 rst_i,
    // extension bus
    input  logic                 req_i,
    input  logic                 is_wr_i,
    input  logic [AxilAddrW-1:0] addr_i,
    input  logic [31:0]          data_i,
    input  logic [31:0]          biten_i,
    output logic [31:0]          rd_data_o,
    output logic                 irq_o,
    // pass
    output logic                 start_o,   // pulse
    output logic                 cancel_o,  // pulse
    output dense_job_t           job_o,
    input  logic                 busy_i,
    input  logic                 done_i,    // pulse
    input  dense_status_e        status_i,
    input  logic                 row_i,     // event
    input  logic                 stall_i    // event
);
  slog_dense_csr_pkg::slog_dense_csr__in_t status, hwif_in;
  slog_dense_csr_pkg::slog_dense_csr__out_t hwif_out;
  logic clk, go, free, start_q, irq_q;
  logic [1:0][31:0] counts;
  logic unused_stall_wr, unused_stall_rd, unused_rd_ack, unused_rd_err, unused_wr_ack, unused_wr_err;

  slog_clock_gate #(
      .Linger(16)
  ) u_gate (
      .clk_i,
      .rst_i,
      .active_i(req_i || done_i),
      .clk_o   (clk)
  );

  slog_dense_csr u_csr (
      .clk,
      .rst                 (rst_i),
      .s_cpuif_req         (req_i),
      .s_cpuif_req_is_wr   (is_wr_i),
      .s_cpuif_addr        (addr_i),
      .s_cpuif_wr_data     (data_i),
      .s_cpuif_wr_biten    (biten_i),
      .s_cpuif_req_stall_wr(unused_stall_wr),
      .s_cpuif_req_stall_rd(unused_stall_rd),
      .s_cpuif_rd_ack      (unused_rd_ack),
      .s_cpuif_rd_err      (unused_rd_err),
      .s_cpuif_rd_data     (rd_data_o),
      .s_cpuif_wr_ack      (unused_wr_ack),
      .s_cpuif_wr_err      (unused_wr_err),
      .hwif_in,
      .hwif_out
  );

  slog_counters #(
      .Events(2)
  ) u_counters (
      .clk_i,
      .rst_i,
      .event_i({stall_i, row_i}),
      .count_o(counts)
  );

  // A start is taken when no pass is under way.
  assign go   = hwif_out.dense.run.go.value;
  assign free = !busy_i && !start_q;
  always_ff @(posedge clk) start_q <= go && free && !rst_i;
  assign start_o  = start_q;
  assign cancel_o = hwif_out.dense.run.cancel.value;
  assign job_o    = '{
      left_slot: hwif_out.dense.planes.left.value,
      right_slot: hwif_out.dense.planes.right.value,
      window: hwif_out.dense.planes.window.value,
      offsets: hwif_out.dense.search.offsets.value,
      start: hwif_out.dense.search.start.value,
      down: hwif_out.dense.vertical.down.value,
      step_x: hwif_out.dense.vertical.step_x.value,
      step_y: hwif_out.dense.vertical.step_y.value,
      most: hwif_out.dense.limits.most.value,
      margin: hwif_out.dense.limits.margin.value,
      check: hwif_out.dense.planes.check.value,
      live: hwif_out.dense.planes.live.value
  };

  // The registers show values one clock late.
  assign status.dense.build.offsets.next    = 9'(Offsets);
  assign status.dense.build.max_window.next = 6'(MaxWindow);
  assign status.dense.build.sizes.next      = 4'(Sizes);
  assign status.dense.build.lanes.next      = 6'(Lanes);
  assign status.dense.run.busy.next         = !free;
  assign status.dense.run.status.next       = status_i;
  assign status.dense.rows.value.next       = counts[0];
  assign status.dense.stalls.value.next     = counts[1];
  assign status.dense.irq_status.done.next  = done_i;
  assign status.dense.irq_status.lost.next  = go && !free;
  always_ff @(posedge clk) begin
    hwif_in <= status;
    if (rst_i) begin
      hwif_in.dense.irq_status.done.next <= 1'b0;
      hwif_in.dense.irq_status.lost.next <= 1'b0;
    end
  end

  always_ff @(posedge clk) begin
    if (rst_i) irq_q <= 1'b0;
    else
      irq_q <= (hwif_out.dense.irq_status.done.value && hwif_out.dense.irq_enable.done.value) ||
               (hwif_out.dense.irq_status.lost.value && hwif_out.dense.irq_enable.lost.value);
  end
  assign irq_o = irq_q;

  `SLOG_ASSERT_INIT(SlogDenseControlAddressWidth, AxilAddrW == slog_dense_csr_pkg::SLOG_DENSE_CSR_MIN_ADDR_WIDTH)
  `SLOG_PAST(past_start, start_o)
  `SLOG_ASSERT(SlogDenseControlStart, !start_o || (!busy_i && !past_start))
endmodule : slog_dense_control
