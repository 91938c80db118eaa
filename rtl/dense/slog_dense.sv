// SPDX-License-Identifier: Apache-2.0
// Port skeleton of the dense engine's block: refuses nothing, computes nothing.
`include "slog_assert.svh"
module slog_dense
  import slog_dense_pkg::*;
#(
    parameter  int unsigned Width       = 64,
    parameter  int unsigned MaxWidth    = 640,
    parameter  int unsigned MaxHeight   = 480,
    parameter  int unsigned WordsPerRow = 10,
    parameter  int unsigned Slots       = 3,
    parameter  int unsigned Offsets     = 128,
    parameter  int unsigned Lanes       = 8,
    parameter  int unsigned MaxWindow   = 32,
    parameter  int unsigned Sizes       = 3,
    parameter  int unsigned OutDepth    = 2048,
    localparam int unsigned AddrW       = $clog2(Slots * MaxHeight * WordsPerRow)
) (
    input  logic                   clk_i,
    input  logic                   rst_i,
    input  logic                   start_i,
    input  dense_job_t             job_i,
    input  logic                   cancel_i,
    input  logic       [      9:0] image_width_i,
    input  logic       [      9:0] image_height_i,
    input  logic       [      7:0] slot_valid_i,
    output logic       [      7:0] slot_busy_o,
    output logic                   rd_valid_o,
    output logic       [AddrW-1:0] rd_addr_o,
    input  logic       [Width-1:0] rd_data_i,
    output logic                   map_tvalid_o,
    input  logic                   map_tready_i,
    output logic       [     63:0] map_tdata_o,
    output logic                   map_tuser_o,   // first word of a map
    output logic                   map_tlast_o,   // last word of a map
    output logic                   busy_o,
    output logic                   done_o,        // pulse: the last word was taken, or the job was refused
    output dense_status_e          status_o,      // of the last start, from done_o on
    output logic                   row_o,         // pulse: a row was started
    output logic                   stall_o        // a clock in which a row waited for room
);
  assign slot_busy_o  = '0;
  assign rd_valid_o   = 1'b0;
  assign rd_addr_o    = '0;
  assign map_tvalid_o = 1'b0;
  assign map_tdata_o  = '0;
  assign map_tuser_o  = 1'b0;
  assign map_tlast_o  = 1'b0;
  assign busy_o       = 1'b0;
  assign done_o       = 1'b0;
  assign status_o     = DenseOk;
  assign row_o        = 1'b0;
  assign stall_o      = 1'b0;
endmodule : slog_dense
