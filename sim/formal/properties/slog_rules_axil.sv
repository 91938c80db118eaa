// SPDX-License-Identifier: Apache-2.0
// AXI4-Lite from the specification (ARM IHI 0022, A3 and B1), and what slog_axil promises the register block.
//
// The host may do anything: raise and lower its valid and ready signals in any clock, with AW and W apart. The register
// block answers each request once, at the earliest one clock after it.
module slog_rules_axil #(
    parameter int unsigned      AddrW    = 8,
    parameter logic [AddrW-1:0] WaitAddr = '0
) (
    input logic             clk_i,
    input logic             rst_i,
    input logic [AddrW-1:0] awaddr_i,
    input logic             awvalid_i,
    input logic             awready_o,
    input logic [31:0]      wdata_i,
    input logic [3:0]       wstrb_i,
    input logic             wvalid_i,
    input logic             wready_o,
    input logic             bvalid_o,
    input logic             bready_i,
    input logic [AddrW-1:0] araddr_i,
    input logic             arvalid_i,
    input logic             arready_o,
    input logic [31:0]      rdata_o,
    input logic             rvalid_o,
    input logic             rready_i,
    input logic             busy_o,
    input logic             wait_i,
    input logic             req_o,
    input logic             req_is_wr_o,
    input logic [AddrW-1:0] req_addr_o,
    input logic [31:0]      req_data_o,
    input logic [31:0]      req_biten_o,
    input logic             wr_ack_i,
    input logic             rd_ack_i,
    input logic [31:0]      rd_data_i,
    input logic             read_q,
    input logic             write_q
);
  // Accepted and not begun; the request of either kind is with the register block. When an access begins, its address
  // and data are moved to taken_q, and the next may be accepted.
  logic aw_q, w_q, ar_q, asked_q, asked_wr_q, b_q, r_q, was_reset_q;
  logic [AddrW-1:0] awaddr_q, araddr_q, taken_addr_q;
  logic [3:0] taken_strb_q;
  logic [31:0] taken_data_q;
  logic [31:0] wdata_q, rdata_q, past_rdata_q;
  logic [3:0] wstrb_q;
  logic [2:0] waits_q;   // wait_i one, two, three clocks ago
  logic [1:0] wrote_q;   // a write's request left one, two clocks ago
  logic [2:0] aw_owed_q, w_owed_q, ar_owed_q;  // transfers accepted and not yet answered
  logic b_waits_q, r_waits_q;                  // a response was offered in the clock before and not taken
  logic [31:0] biten;
  assign biten = {{8{taken_strb_q[3]}}, {8{taken_strb_q[2]}}, {8{taken_strb_q[1]}}, {8{taken_strb_q[0]}}};

  always_ff @(posedge clk_i) begin
    was_reset_q <= rst_i;
    b_waits_q   <= bvalid_o && !bready_i && !rst_i;
    r_waits_q   <= rvalid_o && !rready_i && !rst_i;
    past_rdata_q <= rdata_o;
    waits_q     <= {waits_q[1:0], wait_i};
    wrote_q     <= {wrote_q[0] && !rst_i, req_o && req_is_wr_o && !rst_i};
    if (awvalid_i && awready_o) awaddr_q <= awaddr_i;
    if (wvalid_i && wready_o) {wdata_q, wstrb_q} <= {wdata_i, wstrb_i};
    if (arvalid_i && arready_o) araddr_q <= araddr_i;
    if (read_q) taken_addr_q <= araddr_q;
    if (write_q) {taken_addr_q, taken_data_q, taken_strb_q} <= {awaddr_q, wdata_q, wstrb_q};
    if (rd_ack_i) rdata_q <= rd_data_i;
    if (rst_i) begin
      aw_q    <= 1'b0;
      w_q     <= 1'b0;
      ar_q    <= 1'b0;
      aw_owed_q <= '0;
      w_owed_q  <= '0;
      ar_owed_q <= '0;
      asked_q <= 1'b0;
      b_q     <= 1'b0;
      r_q     <= 1'b0;
    end else begin
      if (awvalid_i && awready_o) aw_q <= 1'b1;
      else if (write_q) aw_q <= 1'b0;
      if (wvalid_i && wready_o) w_q <= 1'b1;
      else if (write_q) w_q <= 1'b0;
      if (arvalid_i && arready_o) ar_q <= 1'b1;
      else if (read_q) ar_q <= 1'b0;
      aw_owed_q <= aw_owed_q + 3'(awvalid_i && awready_o) - 3'(bvalid_o && bready_i);
      w_owed_q  <= w_owed_q + 3'(wvalid_i && wready_o) - 3'(bvalid_o && bready_i);
      ar_owed_q <= ar_owed_q + 3'(arvalid_i && arready_o) - 3'(rvalid_o && rready_i);
      asked_q <= req_o || (asked_q && !wr_ack_i && !rd_ack_i);
      if (req_o) asked_wr_q <= req_is_wr_o;
      b_q <= wr_ack_i || (b_q && !bready_i);
      r_q <= rd_ack_i || (r_q && !rready_i);
    end
    if (!rst_i) begin
      AssumeAnswers : assume (!(wr_ack_i && rd_ack_i) && (!wr_ack_i || (asked_q && asked_wr_q))
                              && (!rd_ack_i || (asked_q && !asked_wr_q)));
      // Handshakes: nothing is accepted in the clock after a reset; a response answers an access, once.
      RulesAxilReset : assert (!was_reset_q || !(awready_o || wready_o || arready_o || bvalid_o || rvalid_o || req_o));
      RulesAxilWriteAnswer : assert (bvalid_o == b_q);
      RulesAxilReadAnswer : assert (rvalid_o == r_q && (!rvalid_o || rdata_o == rdata_q));
      // A3.2.1: once valid, valid and its payload stay until ready. A3.3.1: B only after both AW and W, R only after AR.
      RulesAxilStays : assert ((!b_waits_q || bvalid_o) && (!r_waits_q || (rvalid_o && rdata_o == past_rdata_q)));
      RulesAxilAfter : assert ((!bvalid_o || (aw_owed_q != '0 && w_owed_q != '0)) && (!rvalid_o || ar_owed_q != '0));
      RulesAxilOwed : assert (aw_owed_q <= 3'd2 && w_owed_q <= 3'd2 && ar_owed_q <= 3'd2);
      // Requests: one at a time, each of an accepted access; a write has both its address and its data.
      RulesAxilOne : assert (!req_o || !(asked_q || b_q || r_q));
      RulesAxilBusy : assert (busy_o || !(asked_q || b_q || r_q));
      RulesAxilBegins : assert ((!write_q || (aw_q && w_q)) && (!read_q || ar_q) && !(read_q && write_q));
      RulesAxilAddress : assert (!req_o || req_addr_o == (taken_addr_q & ~AddrW'(3)));
      RulesAxilLow : assert (!(req_o && req_is_wr_o)
                             || (req_data_o[15:0] == taken_data_q[15:0] && req_biten_o[15:0] == biten[15:0]));
      RulesAxilWaits : assert (!(req_o && !req_is_wr_o && req_addr_o == (WaitAddr & ~AddrW'(3))) || !waits_q[2]);
      CoverBoth : cover (req_o && req_is_wr_o && ar_q);
      CoverOvertakes : cover (req_o && req_is_wr_o && ar_q && waits_q == '1 && araddr_q == WaitAddr);
      CoverDataFirst : cover (w_q && !aw_q && !was_reset_q);
      CoverAddressFirst : cover (aw_q && !w_q && !was_reset_q);
      CoverBackToBack : cover (bvalid_o && bready_i && ar_q);
    end
  end

  // Bytes 2 and 3 follow the request.
  always_ff @(posedge clk_i) begin
    if (!rst_i) begin
      RulesAxilByte2 : assert (!wrote_q[0] || (req_data_o[23:16] == taken_data_q[23:16]
                                              && req_biten_o[23:16] == biten[23:16]));
      RulesAxilByte3 : assert (!wrote_q[1] || (req_data_o[31:24] == taken_data_q[31:24]
                                              && req_biten_o[31:24] == biten[31:24]));
    end
  end
endmodule : slog_rules_axil

bind slog_axil slog_rules_axil #(.AddrW(AddrW), .WaitAddr(WaitAddr)) u_rules (.*);
