// SPDX-License-Identifier: Apache-2.0
// slog_control: no read shows a status of less than Apart clocks after a submit; commands lie apart.
//
// A read is answered ReadClocks after the clock of the status that it shows: one register before the register block, three
// in it.
module slog_rules_control #(
    parameter int unsigned Apart = 6
) (
    input logic clk_i,
    input logic rst_i,
    input logic job_valid_o,
    input logic capture_valid_o,
    input logic rd_ack,
    input logic [3:0] begin_q,     // of slog_axil: an access began k clocks ago
    input logic [5:0] csr_q,      // of slog_csr: a request, by its clocks since req_o
    input logic under_way_q,
    input logic [1:0] answers      // bvalid_o, rvalid_o
);
  localparam int unsigned ReadClocks = 4;
  logic [ReadClocks+Apart-1:0] submit_q;  // [k]: job_valid_o k + 1 clocks ago
  logic [6:0] capture_q;                  // [k]: capture_valid_o k + 1 clocks ago
  always_ff @(posedge clk_i) begin
    capture_q <= {capture_q[5:0], capture_valid_o} & {7{!rst_i}};
    submit_q <= {submit_q[ReadClocks+Apart-2:0], job_valid_o} & {ReadClocks + Apart{!rst_i}};
    if (!rst_i) begin
      RulesControlApart : assert (!rd_ack || submit_q[ReadClocks+Apart-2:0] == '0);
      // slog_rules_capture_slots assumes that four clocks lie between two commands.
      RulesControlCaptures : assert (!capture_valid_o || capture_q == '0);
      // An access is in one place from its begin until its response is taken.
      RulesControlOnePlace : assert ($countones({begin_q[2:0], csr_q, answers}) == 32'(under_way_q));
      CoverNext : cover (rd_ack && submit_q[ReadClocks+Apart-1]);
    end
  end
endmodule : slog_rules_control

bind slog_control slog_rules_control u_rules (
    .clk_i, .rst_i, .job_valid_o, .capture_valid_o, .rd_ack, .begin_q(u_axil.begin_q),
    .csr_q({u_csr.asked_req, u_csr.found_req, u_csr.decoded_req, u_csr.readback_read, u_csr.readback_done}),
    .under_way_q(u_axil.under_way_q), .answers({u_axil.bvalid_q, u_axil.rvalid_q}));
