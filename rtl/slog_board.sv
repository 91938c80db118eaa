// The board: two cameras, sign-of-LoG front ends, bit-plane store, correlator, registers. Wiring only.
//
// Registers  : AXI4-Lite, rtl/slog_csr.rdl.
// Video      : AXI4-Stream per camera, 8-bit grey, tuser = start of frame, tlast = end of line; one pixel per clock.
// Surface    : AXI4-Stream of scores in raster order for jobs that ask for it; tuser = first, tlast = last of a job.
module slog_board
  import slog_cfg_pkg::*;
(
    input  logic                    clk_i,
    input  logic                    rst_i,
    input  logic [7:0]              s_axil_awaddr,
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
    input  logic [7:0]              s_axil_araddr,
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
    output logic [15:0]             surf_tdata_o,
    output logic                    surf_tvalid_o,
    input  logic                    surf_tready_i,
    output logic                    surf_tuser_o,
    output logic                    surf_tlast_o,
    output logic                    irq_o
);
endmodule : slog_board
