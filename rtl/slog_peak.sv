// Peak unit: from the array's mismatch counts to each job's best score, its neighbours and the runner-up.
//
// score = area - mismatch, in raster order over the offsets of a job.
//
// Handshake  : the array cannot be stopped within a row of offsets, so room for a whole row is reserved before it starts:
//              a row may start in a clock with row_valid_i and row_ready_o (row_offsets_i = the job's offsets_x, counted
//              in that clock). row_ready_o does not depend on row_valid_i and is low for one clock after each grant.
//              A job's context must be taken (ctx_valid_i, ctx_ready_o) no later than in the clock of its first grant.
//              Scores of granted rows come in grant order, gaps allowed; they are never refused.
// Formats    : mismatch_i unsigned; scores ScoreW bits; absent scores in res_o are NoScore.
// Ties       : the first in raster order is the best.
`include "slog_assert.svh"
module slog_peak
  import slog_pkg::*;
#(
    parameter  int unsigned MaxOffsets  = 640,          // offsets across, at most
    parameter  int unsigned ScoreBits   = 15,           // bits of mismatch_i
    parameter  int unsigned ScoreDepth  = 1024,         // scores held between array and peak search, >= MaxOffsets
    parameter  int unsigned ResultDepth = 64,           // results held for the host
    localparam int unsigned ResultLevelW = $clog2(ResultDepth + 1)
) (
    input  logic                    clk_i,
    input  logic                    rst_i,
    // Contexts in job order, refused jobs too.
    input  logic                    ctx_valid_i,
    output logic                    ctx_ready_o,
    input  context_t                ctx_i,
    // Row grants.
    input  logic                    row_valid_i,
    output logic                    row_ready_o,
    input  logic [9:0]              row_offsets_i,
    // Array.
    input  logic                    mismatch_valid_i,
    input  logic [ScoreBits-1:0]    mismatch_i,
    // Scores of jobs that asked for their surface: raster order, tuser = first of the job, tlast = last of the job.
    output logic                    surf_tvalid_o,
    input  logic                    surf_tready_i,
    output logic [15:0]             surf_tdata_o,
    output logic                    surf_tuser_o,
    output logic                    surf_tlast_o,
    // Results in job order.
    output logic                    res_valid_o,
    input  logic                    res_ready_i,
    output result_t                 res_o,
    output logic [ResultLevelW-1:0] res_level_o
);
  assign ctx_ready_o   = 1'b0;
  assign row_ready_o   = 1'b0;
  assign surf_tvalid_o = 1'b0;
  assign surf_tdata_o  = '0;
  assign surf_tuser_o  = 1'b0;
  assign surf_tlast_o  = 1'b0;
  assign res_valid_o   = 1'b0;
  assign res_o         = '0;
  assign res_level_o   = '0;
endmodule : slog_peak
