// SPDX-License-Identifier: Apache-2.0
// slog_control with the members of its AXI4-Lite structs as ports of their own, and room for an extension.
module tb_control
  import slog_pkg::*;
  import slog_cfg_pkg::*;
#(
    localparam int unsigned AddrW = $clog2(StoreWords)
) (
    input  logic                           clk_i,
    input  logic                           rst_i,
    input  logic [AxilAddrW-1:0]           s_axil_awaddr,
    input  logic [2:0]                     s_axil_awprot,
    input  logic                           s_axil_awvalid,
    output logic                           s_axil_awready,
    input  logic [31:0]                    s_axil_wdata,
    input  logic [3:0]                     s_axil_wstrb,
    input  logic                           s_axil_wvalid,
    output logic                           s_axil_wready,
    output logic [1:0]                     s_axil_bresp,
    output logic                           s_axil_bvalid,
    input  logic                           s_axil_bready,
    input  logic [AxilAddrW-1:0]           s_axil_araddr,
    input  logic [2:0]                     s_axil_arprot,
    input  logic                           s_axil_arvalid,
    output logic                           s_axil_arready,
    output logic [31:0]                    s_axil_rdata,
    output logic [1:0]                     s_axil_rresp,
    output logic                           s_axil_rvalid,
    input  logic                           s_axil_rready,
    // front ends
    output logic [Cameras-1:0]             hold_o,
    output logic [Cameras-1:0]             abort_o,
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
    input  logic                           work_i,           // a job is in work
    input  logic                           score_i,          // a score was computed
    // plane read-back
    output logic                           peek_valid_o,
    input  logic                           peek_ready_i,
    output logic [AddrW-1:0]               peek_addr_o,
    input  logic                           peek_done_i,
    input  logic [GroupBits-1:0]           peek_data_i,
    // extension
    output logic                           ext_req_o,
    output logic                           ext_is_wr_o,
    output logic [AxilAddrW-1:0]           ext_addr_o,
    output logic [31:0]                    ext_data_o,
    output logic [31:0]                    ext_biten_o,
    input  logic [31:0]                    ext_rd_data_i,
    input  logic                           ext_irq_i,
    output logic                           irq_o
);
  axil_req_t axil_i;
  axil_rsp_t axil_o;
  assign axil_i = '{
      awaddr: s_axil_awaddr, awprot: s_axil_awprot, awvalid: s_axil_awvalid,
      wdata: s_axil_wdata, wstrb: s_axil_wstrb, wvalid: s_axil_wvalid, bready: s_axil_bready,
      araddr: s_axil_araddr, arprot: s_axil_arprot, arvalid: s_axil_arvalid, rready: s_axil_rready
  };
  assign s_axil_awready = axil_o.awready;
  assign s_axil_wready  = axil_o.wready;
  assign s_axil_bresp   = axil_o.bresp;
  assign s_axil_bvalid  = axil_o.bvalid;
  assign s_axil_arready = axil_o.arready;
  assign s_axil_rdata   = axil_o.rdata;
  assign s_axil_rresp   = axil_o.rresp;
  assign s_axil_rvalid  = axil_o.rvalid;

  slog_control #(
      .Extension(1'b1)
  ) u_dut (
      .*
  );
endmodule : tb_control
