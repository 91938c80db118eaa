// SPDX-License-Identifier: Apache-2.0
// AXI4-Lite to the register block's request port, one access at a time; every output is a register.
//
// When a read and a write both wait, they take turns. A read of WaitAddr waits while wait_i is high; writes overtake it.
// The pins lie far apart: two pipeline registers follow every address and data input, and k more byte k of written data.
//
// Latency    : a request leaves 5 clocks after its address, and of a write its data, were accepted; bvalid and rvalid
//              follow the register block's answer by 1 clock. Address and data of a request are held until its answer;
//              bytes 2 and 3 of the data follow req_o by 1 and 2 clocks. Nothing is accepted in reset.
// Throughput : one access per 5 clocks plus the register block's latency, if its response is accepted at once.
// Formats    : byte addresses; the low two bits are ignored.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_axil #(
    parameter int unsigned      AddrW    = 8,
    parameter logic [AddrW-1:0] WaitAddr = '0
) (
    input  logic             clk_i,
    input  logic             rst_i,
    // host
    input  logic [AddrW-1:0] awaddr_i,
    input  logic             awvalid_i,
    output logic             awready_o,
    input  logic [31:0]      wdata_i,
    input  logic [3:0]       wstrb_i,
    input  logic             wvalid_i,
    output logic             wready_o,
    output logic             bvalid_o,
    input  logic             bready_i,
    input  logic [AddrW-1:0] araddr_i,
    input  logic             arvalid_i,
    output logic             arready_o,
    output logic [31:0]      rdata_o,
    output logic             rvalid_o,
    input  logic             rready_i,
    output logic             busy_o,         // an access waits or is in progress
    // register block
    input  logic             wait_i,
    output logic             req_o,          // pulse
    output logic             req_is_wr_o,
    output logic [AddrW-1:0] req_addr_o,
    output logic [31:0]      req_data_o,
    output logic [31:0]      req_biten_o,    // [i]: write bit i
    input  logic             wr_ack_i,
    input  logic             rd_ack_i,
    input  logic [31:0]      rd_data_i
);
  logic aw_q, w_q, ar_q;       // a write address, data, a read address waits
  logic aw_free_q, w_free_q, ar_free_q;  // inverted copies of these; 0 in reset
  logic aw, w, ar;
  logic ar_waits_q;            // the waiting read is of WaitAddr
  logic aw_q2, w_q2, ar_q2;    // they wait, and are in awaddr_q3, wait_q, araddr_q3 from the next clock on
  logic aw_new_q, aw_new_q2, ar_new_q, ar_new_q2;  // an address may have been accepted one, two clocks before
  logic [4:0] w_new_q;         // [k]: data may have been accepted k + 1 clocks before
  logic [AddrW-1:0] awaddr_q, awaddr_q2, awaddr_q3, araddr_q, araddr_q2, araddr_q3, addr_q, addr_q2;
  logic [31:0] rdata_q;
  logic under_way_q, read_last_q, is_wr_q, is_wr_q2, bvalid_q, rvalid_q;
  logic read_q, write_q;       // a read, a write begins
  logic [3:0] begin_q;         // [k]: either began k clocks before; separate, because it enables the request registers
  logic can_read, can_write;

  assign can_read  = ar_q2 && !(ar_waits_q && wait_i) && !under_way_q;
  assign can_write = aw_q2 && w_q2 && !under_way_q;
  assign aw        = (aw_q || (awvalid_i && aw_free_q)) && !write_q;
  assign w         = (w_q || (wvalid_i && w_free_q)) && !write_q;
  assign ar        = (ar_q || (arvalid_i && ar_free_q)) && !read_q;

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      aw_q        <= 1'b0;
      w_q         <= 1'b0;
      ar_q        <= 1'b0;
      aw_free_q   <= 1'b0;
      w_free_q    <= 1'b0;
      ar_free_q   <= 1'b0;
      begin_q     <= '0;
      under_way_q <= 1'b0;
      read_q      <= 1'b0;
      write_q     <= 1'b0;
      read_last_q <= 1'b0;
      aw_q2       <= 1'b0;
      w_q2        <= 1'b0;
      ar_q2       <= 1'b0;
      aw_new_q    <= 1'b0;
      aw_new_q2   <= 1'b0;
      ar_new_q    <= 1'b0;
      ar_new_q2   <= 1'b0;
      w_new_q     <= '0;
      bvalid_q    <= 1'b0;
      rvalid_q    <= 1'b0;
    end else begin
      read_q    <= can_read && !(can_write && read_last_q);
      write_q   <= can_write && !(can_read && !read_last_q);
      aw_q      <= aw;
      w_q       <= w;
      ar_q      <= ar;
      aw_free_q <= !aw;
      w_free_q  <= !w;
      ar_free_q <= !ar;
      begin_q   <= {begin_q[2:0], can_read || can_write};
      aw_q2     <= aw_q && !write_q;
      w_q2      <= w_q && !write_q;
      ar_q2     <= ar_q && !read_q;
      aw_new_q  <= aw_free_q;
      aw_new_q2 <= aw_new_q;
      ar_new_q  <= ar_free_q;
      ar_new_q2 <= ar_new_q;
      w_new_q   <= {w_new_q[3:0], w_free_q};
      bvalid_q  <= wr_ack_i || (bvalid_q && !bready_i);
      rvalid_q  <= rd_ack_i || (rvalid_q && !rready_i);
      if (read_q) read_last_q <= 1'b1;
      if (write_q) read_last_q <= 1'b0;
      if (can_read || can_write) under_way_q <= 1'b1;
      else if ((bvalid_q && bready_i) || (rvalid_q && rready_i)) under_way_q <= 1'b0;
    end
  end

  always_ff @(posedge clk_i) begin
    awaddr_q  <= awaddr_i;
    awaddr_q2 <= awaddr_q;
    if (aw_new_q2) awaddr_q3 <= awaddr_q2;
    araddr_q  <= araddr_i;
    araddr_q2 <= araddr_q;
    if (ar_new_q2) araddr_q3 <= araddr_q2;
    if (ar_new_q) ar_waits_q <= araddr_q[AddrW-1:2] == WaitAddr[AddrW-1:2];
    if (begin_q[0]) begin
      addr_q  <= write_q ? awaddr_q3 : araddr_q3;
      is_wr_q <= write_q;
    end
    addr_q2  <= addr_q;
    is_wr_q2 <= is_wr_q;
    if (rd_ack_i) rdata_q <= rd_data_i;
  end

  assign awready_o   = aw_free_q;
  assign wready_o    = w_free_q;
  assign arready_o   = ar_free_q;
  assign bvalid_o    = bvalid_q;
  assign rvalid_o    = rvalid_q;
  assign rdata_o     = rdata_q;
  assign busy_o      = aw_q || w_q || ar_q || under_way_q;
  assign req_o       = begin_q[2];
  assign req_is_wr_o = is_wr_q2;
  assign req_addr_o  = addr_q2 & ~AddrW'(3);

  // Each byte of written data has its own delay and enables, to limit fan-out.
  for (genvar k = 0; k < 4; k++) begin : g_byte
    logic [8:0] way_q[k+2], wait_q, data_q;  // [8] is the strobe
    always_ff @(posedge clk_i) begin
      for (int unsigned n = 0; n < k + 2; n++)
        way_q[n] <= (n == 0) ? {wstrb_i[k], wdata_i[8*k+:8]} : way_q[(n==0)?0 : n-1];
      if (w_new_q[k+1]) wait_q <= way_q[k+1];
      if (begin_q[k]) data_q <= wait_q;
    end
    assign req_data_o[8*k+:8]  = data_q[7:0];
    assign req_biten_o[8*k+:8] = {8{data_q[8]}};
  end

  `SLOG_ASSERT(SlogAxilCopies, begin_q[0] == (read_q || write_q)
                               && !(aw_q && aw_free_q) && !(w_q && w_free_q) && !(ar_q && ar_free_q))
  `SLOG_ASSERT(SlogAxilAnswerExpected, !(wr_ack_i || rd_ack_i) || (under_way_q && !(wr_ack_i && rd_ack_i)))
  `SLOG_PAST(past_request, {req_is_wr_o, req_addr_o})
  `SLOG_ASSERT(SlogAxilRequestStays, !under_way_q || req_o || {req_is_wr_o, req_addr_o} == past_request)
  `SLOG_ASSERT_STABLE(SlogAxilWriteStable, bvalid_o, bready_i, bvalid_o)
  `SLOG_ASSERT_STABLE(SlogAxilReadStable, rvalid_o, rready_i, rdata_o)
endmodule : slog_axil
