// SPDX-License-Identifier: Apache-2.0
// Types shared by several blocks. Widths are those of the largest board; smaller boards use fewer values.
//
// Score: matching bits of a window, 0..width*height. NoScore marks an absent score.
// Ties : of equal scores the first in raster order (smaller row, then smaller column) is the best.
// Sign : a bit is 1 where the LoG response is > 0, else 0.
package slog_pkg;
  localparam int unsigned ScoreW = 15;
  localparam logic [ScoreW-1:0] NoScore = '1;

  // Outcome of a job's check: Ok, or the first reason for refusal in this order. A refused job yields a result with its
  // status and no scores.
  typedef enum logic [2:0] {
    StatusOk        = 3'd0,
    StatusBadWindow = 3'd1,  // width or height outside MinWindow..MaxWindow
    StatusNoOffsets = 3'd2,  // no offsets across or down
    StatusBadSlot   = 3'd3,  // slot not on this board, or holds no frame
    StatusOutside   = 3'd4   // template or search reaches outside the image
  } status_e;

  // A correlation job. At offset (0, 0) the window's top left corner in the search image is (search_x, search_y).
  typedef struct packed {
    logic [15:0] tag;
    logic        surface;    // stream every score out
    logic [2:0]  tpl_slot;
    logic [9:0]  tpl_x;
    logic [9:0]  tpl_y;
    logic [7:0]  width;
    logic [7:0]  height;
    logic [2:0]  search_slot;
    logic [9:0]  search_x;
    logic [9:0]  search_y;
    logic [9:0]  offsets_x;  // offsets across
    logic [9:0]  offsets_y;  // offsets down
  } job_t;

  // The part of a job that the peak unit needs, in job order.
  typedef struct packed {
    logic [15:0]       tag;
    logic              surface;
    status_e           status;
    logic [9:0]        offsets_x;
    logic [9:0]        offsets_y;
    logic [ScoreW-1:0] area;     // width * height
  } context_t;

  // One clock of operands entering the array.
  typedef struct packed {
    logic       valid;
    logic       first;     // first step of a pass: the lanes start from zero
    logic       last;      // last step of a pass
    logic       wide;      // both groups carry one row of a window wider than GroupBits
    logic       row_b;     // group B is in use: always when wide; else it carries the row after group A's
    logic       bank;      // template bank
    logic [6:0] tpl_step;  // template row (wide) or row pair
    logic [7:0] ring_row;  // ring row of group A
    logic [4:0] chunk;     // first offset of the pass in units of Pitch
    logic [5:0] lanes;     // offsets this pass scores, 1..Lanes
  } step_t;

  // Result of a finished job. The neighbours of the best offset in raster order: NW N NE W E SW S SE.
  typedef struct packed {
    logic [15:0]            tag;
    status_e                status;
    logic [9:0]             best_x;     // offset from search_x
    logic [9:0]             best_y;
    logic [ScoreW-1:0]      score;
    logic [7:0][ScoreW-1:0] neighbour;  // [0] is NW
    logic [ScoreW-1:0]      runner_up;  // best score outside the best's 3x3 neighbourhood
  } result_t;

  // AXI4-Lite, all five channels: what the host drives, and what the board drives.
  localparam int unsigned AxilAddrW = 8;

  typedef struct packed {
    logic [AxilAddrW-1:0] awaddr;
    logic [2:0]           awprot;
    logic                 awvalid;
    logic [31:0]          wdata;
    logic [3:0]           wstrb;
    logic                 wvalid;
    logic                 bready;
    logic [AxilAddrW-1:0] araddr;
    logic [2:0]           arprot;
    logic                 arvalid;
    logic                 rready;
  } axil_req_t;

  typedef struct packed {
    logic        awready;
    logic        wready;
    logic [1:0]  bresp;
    logic        bvalid;
    logic        arready;
    logic [31:0] rdata;
    logic [1:0]  rresp;
    logic        rvalid;
  } axil_rsp_t;
endpackage : slog_pkg
