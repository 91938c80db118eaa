// SPDX-License-Identifier: Apache-2.0
// AXI4-Lite from the specification (ARM IHI 0022, A3 and B1), and what slog_axil promises the register block.
//
// The host may do anything: raise and lower its valid and ready signals in any clock, with AW and W apart. The register
// block answers each request once, at the earliest one clock after it.
//
// For the induction: where an address, or a byte of data, is on its way to the register that the access reads; and that an
// access is in one place from its begin to its response.
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
    input logic             write_q,
    input logic             under_way_q,
    input logic [3:0]       begin_q,
    input logic             aw_q2,
    input logic             w_q2,
    input logic             ar_q2,
    input logic             aw_new_q,
    input logic             aw_new_q2,
    input logic             ar_new_q,
    input logic             ar_new_q2,
    input logic [4:0]       w_new_q,
    input logic             ar_waits_q,
    input logic             is_wr_q,
    input logic             is_wr_q2,
    input logic [AddrW-1:0] addr_q,
    input logic [AddrW-1:0] addr_q2,
    // The module's own: what waits; the ways of addresses and data, the latest first, and their ends.
    input logic [2:0]            own_waiting,
    input logic [2:0][AddrW-1:0] own_awaddr,
    input logic [2:0][AddrW-1:0] own_araddr,
    input logic [3:0][4:0][8:0]  own_way,
    input logic [3:0][8:0]       own_wait,
    input logic [3:0][8:0]       own_data
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
  logic [4:0] place;       // the access: three clocks of its begin, with the register block, its response
  logic [3:0] waited, taken, done;  // [k]: byte k of the data is where it should be: it waits, is about to be taken, is taken
  // The byte whose way began as many clocks ago as the lowest of the marks says; past the way's end it waits.
  function automatic logic [8:0] along(logic [4:0] marks, logic [4:0][8:0] way, logic [8:0] wait_end, int unsigned length);
    along = wait_end;
    for (int n = 4; n >= 0; n--) if (marks[n] && n < int'(length)) along = way[n];
  endfunction
  assign place = {b_q || r_q, asked_q, begin_q[2:0]};
  always_comb begin
    for (int unsigned k = 0; k < 4; k++) begin
      waited[k] = along(w_new_q, own_way[k], own_wait[k], k + 2) == {wstrb_q[k], wdata_q[8*k+:8]};
      taken[k]  = 1'b1;
      for (int unsigned n = 1; n <= k; n++)
        if (begin_q[n]) taken[k] = along(w_new_q & ('1 << n), own_way[k], own_wait[k], k + 2)
                                   == {taken_strb_q[k], taken_data_q[8*k+:8]};
      done[k] = own_data[k] == {taken_strb_q[k], taken_data_q[8*k+:8]};
    end
  end
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
      RulesAxilWaiting : assert (own_waiting == {ar_q, w_q, aw_q} && !(aw_q2 && (!aw_q || aw_new_q))
                                 && !(w_q2 && (!w_q || w_new_q[0])) && !(ar_q2 && (!ar_q || ar_new_q)));
      RulesAxilPlace : assert ($onehot0(place) && !(b_q && r_q) && under_way_q == (place != '0)
                               && (!begin_q[3] || asked_q) && begin_q[0] == (read_q || write_q));
      RulesAxilSettled : assert (!(write_q && (aw_new_q2 || w_new_q[1:0] != '0)) && !(read_q && (ar_new_q || ar_new_q2)));
      RulesAxilAw : assert (!aw_q || awaddr_q == (aw_new_q ? own_awaddr[0] : aw_new_q2 ? own_awaddr[1] : own_awaddr[2]));
      RulesAxilAr : assert (!ar_q || araddr_q == (ar_new_q ? own_araddr[0] : ar_new_q2 ? own_araddr[1] : own_araddr[2]));
      RulesAxilWaitsAt : assert (!ar_q || ar_new_q || ar_waits_q == (araddr_q[AddrW-1:2] == WaitAddr[AddrW-1:2]));
      RulesAxilKind : assert ((place[4:1] == '0 || ((!place[4] || is_wr_q == b_q) && (!asked_q || is_wr_q == asked_wr_q)
                                                    && addr_q == taken_addr_q))
                              && (was_reset_q || begin_q[1] || {is_wr_q2, addr_q2} == {is_wr_q, addr_q}));
      RulesAxilCount : assert (aw_owed_q == 3'(aw_q) + 3'(place[4:1] != '0 && is_wr_q)
                               && w_owed_q == 3'(w_q) + 3'(place[4:1] != '0 && is_wr_q)
                               && ar_owed_q == 3'(ar_q) + 3'(place[4:1] != '0 && !is_wr_q));
      RulesAxilHeldUp : assert (!(read_q && ar_waits_q && waits_q[0])
                                && (is_wr_q || taken_addr_q[AddrW-1:2] != WaitAddr[AddrW-1:2]
                                    || !((begin_q[1] && waits_q[1]) || (begin_q[2] && waits_q[2]))));
      RulesAxilBytes : assert ((!w_q || waited == '1) && (!is_wr_q || taken == '1));
      RulesAxilMarks : assert (!(begin_q[1] && is_wr_q && w_new_q[2:0] != '0) && !(begin_q[2] && is_wr_q && w_new_q[3:1] != '0)
                               && !(begin_q[3] && is_wr_q && w_new_q[4:2] != '0));
      RulesAxilDone : assert (!is_wr_q || ((place[4:1] == '0 || done[0]) && (place[4:2] == '0 || done[1])
                                           && (place[4:3] == '0 || done[2])
                                           && (place[4:3] == '0 || begin_q[3] || done[3])));
      RulesAxilWrote : assert (wrote_q[0] == (begin_q[3] && is_wr_q)
                               && (!wrote_q[1] || (place[4:3] != '0 && !begin_q[3] && is_wr_q)));
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

bind slog_axil slog_rules_axil #(.AddrW(AddrW), .WaitAddr(WaitAddr)) u_rules (
    .own_waiting({ar_q, w_q, aw_q}), .own_awaddr({awaddr_q3, awaddr_q2, awaddr_q}),
    .own_araddr({araddr_q3, araddr_q2, araddr_q}),
    .own_way({g_byte[3].way_q[4], g_byte[3].way_q[3], g_byte[3].way_q[2], g_byte[3].way_q[1], g_byte[3].way_q[0],
              9'b0, g_byte[2].way_q[3], g_byte[2].way_q[2], g_byte[2].way_q[1], g_byte[2].way_q[0],
              18'b0, g_byte[1].way_q[2], g_byte[1].way_q[1], g_byte[1].way_q[0],
              27'b0, g_byte[0].way_q[1], g_byte[0].way_q[0]}),
    .own_wait({g_byte[3].wait_q, g_byte[2].wait_q, g_byte[1].wait_q, g_byte[0].wait_q}),
    .own_data({g_byte[3].data_q, g_byte[2].data_q, g_byte[1].data_q, g_byte[0].data_q}), .*);
