// SPDX-License-Identifier: Apache-2.0
// Sends the rows of two planes in the store to the dense engine, each with the row a window's height above it.
//
//   row y: left rows y and y - window; right rows y - down and y - down - window; 0 outside the plane, and in the first
//   rows, which nothing leaves.
//
// The left row and the right row begin left_delay and right_delay clocks after they could, so that the right pixel for offset
// 0 comes with the left one. Each begins while the other's last one may still be under way.
//
//   clocks after row_i
//   2..5   rows' addresses, and whether they lie in their planes
//   4      the delays begin
//   5 + d  row_t counts, d the plane's delay: with the next row_i at the latest; slog_dense_stream registers it
//   6 + d  start of slog_dense_stream
//   26 + d first column at the engine
//   clocks after a wish of a stream
//   0..3   granted: each of the four rows has every fourth clock
//   1      rd_valid_o and rd_addr_o
//   11     rd_data_i: StoreLatency later; data_q and data_q2 follow, one near the store and one near the streams
// Latency    : as above.
// Throughput : a column of both planes per clock; the store is read in at most 4 of Width clocks.
// Rules      : begin_i 2 clocks or more before the first row_i of a pass. plan_i, down_i, width_i and height_i are constant
//              from the clock before it to the pass' end. plan_i.pitch clocks or more lie between rows.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_dense_feed
  import slog_dense_pkg::*, slog_store_pkg::*;
#(
    parameter int unsigned Width       = 64,
    parameter int unsigned WordsPerRow = 10,
    parameter int unsigned AddrW       = 14
) (
    input  logic                    clk_i,
    input  logic                    rst_i,
    input  logic                    begin_i,
    input  logic                    row_i,
    input  plan_t                   plan_i,
    input  logic signed [      9:0] down_i,
    input  logic        [      9:0] width_i,
    input  logic        [      9:0] height_i,
    output logic                    rd_valid_o,
    output logic        [AddrW-1:0] rd_addr_o,
    input  logic        [Width-1:0] rd_data_i,
    output logic                    left_valid_o,
    output logic                    first_o,
    output logic                    left_incoming_o,
    output logic                    left_leaving_o,
    output logic        [      1:0] left_ok_o,
    output logic                    right_valid_o,
    output logic                    right_incoming_o,
    output logic                    right_leaving_o,
    output logic        [      1:0] right_ok_o,
    output logic                    busy_o            // rows are under way: from the clock after a start of a stream on
);
  localparam int unsigned Settle  = 4;
  localparam int unsigned Answers = StoreLatency + 2;  // from rd_valid_o to data_q2
  typedef logic [AddrW-1:0] addr_t;
  typedef logic signed [11:0] line_t;

  // What is constant in a pass comes from afar: nothing is computed before these. Width and height are inverted, because
  // other copies of the same registers, elsewhere, would be merged with them.
  // Pitch, words and window are for others.
  /* verilator lint_off UNUSEDSIGNAL */
  plan_t plan_q;
  /* verilator lint_on UNUSEDSIGNAL */
  logic signed [9:0] down_q;
  logic [9:0] not_width_q, not_height_q, width, height;
  logic begin_q;
  addr_t [1:0] above_q;                // words of the row a window's height above row 0
  line_t limit_q;                      // sum of the image's and the window's height
  logic [1:0][10:0] delay_q;           // a plane's delay, less one
  assign width  = ~not_width_q;
  assign height = ~not_height_q;
  always_ff @(posedge clk_i) begin
    plan_q       <= plan_i;
    down_q       <= down_i;
    not_width_q  <= ~width_i;
    not_height_q <= ~height_i;
    above_q[0]   <= addr_t'(plan_q.left - plan_q.above);
    above_q[1]   <= addr_t'(plan_q.right - plan_q.above);
    delay_q[0]   <= 11'(plan_q.left_delay) - 1'b1;
    delay_q[1]   <= 11'(plan_q.right_delay) - 1'b1;
    limit_q      <= line_t'({2'b00, height}) - line_t'(signed'({1'b1, plan_q.mask}));
    if (rst_i) begin_q <= 1'b0;
    else begin_q <= begin_i;
  end

  // Rows of the planes, left first: number, and words of the incoming and the leaving row.
  logic fresh_q;
  logic moves_q;                       // the rows are the pass's first or the next; it enables their registers
  logic [9:0] y_q;
  line_t r_q;
  addr_t [1:0] incoming_q, leaving_q;
  logic [Settle-1:0] row_q;
  // What follows of them.
  logic first_q, late_q, left_ok_q, right_in_q, right_in_q2, over_q, under_q, right_above_q, right_tall_q, right_ok_q;
  logic [9:0] y_after_q;
  line_t r_after_q, r_first_q;

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      row_q   <= '0;
      moves_q <= 1'b0;
    end else begin
      row_q   <= {row_q[Settle-2:0], row_i};
      moves_q <= begin_i || (row_i && !fresh_q);
    end
  end
  // The right row that leaves the window, a window's height above; over_q, under_q: it lies above, below the image.
  /* verilator lint_off UNUSEDSIGNAL */
  line_t r_leaving;
  /* verilator lint_on UNUSEDSIGNAL */
  assign r_leaving = r_q + line_t'(signed'({1'b1, plan_q.mask}));

  always_ff @(posedge clk_i) begin
    r_first_q <= -line_t'(down_q);
    y_after_q <= y_q + 1'b1;
    r_after_q <= r_q + 1'b1;
    if (moves_q) begin
      y_q           <= begin_q ? '0 : y_after_q;
      r_q           <= begin_q ? r_first_q : r_after_q;
      incoming_q[0] <= begin_q ? addr_t'(plan_q.left) : incoming_q[0] + addr_t'(WordsPerRow);
      incoming_q[1] <= begin_q ? addr_t'(plan_q.right) : incoming_q[1] + addr_t'(WordsPerRow);
      leaving_q[0]  <= begin_q ? above_q[0] : leaving_q[0] + addr_t'(WordsPerRow);
      leaving_q[1]  <= begin_q ? above_q[1] : leaving_q[1] + addr_t'(WordsPerRow);
    end
    if (begin_q) fresh_q <= 1'b1;
    else if (row_i) fresh_q <= 1'b0;
    first_q       <= y_q == '0;
    late_q        <= (y_q & plan_q.mask) != '0;
    left_ok_q     <= (y_after_q & plan_q.mask) != '0;
    right_in_q    <= !r_q[11] && r_q < line_t'({2'b00, height});
    right_tall_q  <= (r_after_q[10:0] & {1'b1, plan_q.mask}) != '0;
    right_ok_q    <= right_in_q2 && right_tall_q;
    right_in_q2   <= right_in_q;
    over_q        <= r_leaving[11];
    under_q       <= r_q >= limit_q;
    right_above_q <= late_q && !over_q && !under_q;
  end

  function automatic logic [1:0] rows_ok(logic ok, logic odd);
    return {ok && odd, ok && !odd};
  endfunction

  row_t [1:0] row;
  assign row[0] = '{
          incoming: 16'(incoming_q[0]),
          leaving: 16'(leaving_q[0]),
          has_incoming: 1'b1,
          has_leaving: late_q,
          column: '0,
          skip: '0,
          count: width,
          ok: rows_ok(left_ok_q, y_q[0]),
          first: first_q
      };
  assign row[1] = '{
          incoming: 16'(incoming_q[1]),
          leaving: 16'(leaving_q[1]),
          has_incoming: right_in_q2,
          has_leaving: right_above_q,
          column: plan_q.column,
          skip: plan_q.skip,
          count: plan_q.count,
          ok: rows_ok(right_ok_q, y_q[0]),
          first: 1'b0
      };

  // Delays: negative where one is over.
  logic [1:0] waits_q, over, start_q;
  logic [1:0][10:0] wait_q;
  assign over[0] = wait_q[0][10];
  assign over[1] = wait_q[1][10];
  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      waits_q <= '0;
      start_q <= '0;
    end else begin
      waits_q <= row_q[Settle-1] ? {plan_q.meets, 1'b1} : waits_q & ~over;
      start_q <= waits_q & over;
    end
  end
  always_ff @(posedge clk_i) begin
    for (int unsigned n = 0; n < 2; n++) begin
      if (row_q[Settle-1]) wait_q[n] <= delay_q[n];
      else wait_q[n] <= wait_q[n] - 1'b1;
    end
  end

  // The read port: turn_q's row has it. [0], [1]: the left plane's rows, [2], [3] the right one's.
  logic [3:0] turn_q;   // one-hot
  logic [3:0] want, grant, granted_q;
  addr_t [3:0] addr;
  logic [Answers-1:0][3:0] asked_q;
  logic rd_valid_q;
  addr_t rd_addr_q, rd_addr;
  logic [Width-1:0] data_q, data_q2;
  assign grant = want & turn_q;
  always_comb begin
    rd_addr = '0;
    for (int unsigned n = 0; n < 4; n++) rd_addr |= addr[n] & {AddrW{turn_q[n]}};
  end
  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      turn_q     <= 4'd1;
      granted_q  <= '0;
      rd_valid_q <= 1'b0;
      asked_q    <= '0;
    end else begin
      turn_q     <= {turn_q[2:0], turn_q[3]};
      granted_q  <= grant;
      rd_valid_q <= grant != '0;
      asked_q    <= {asked_q[Answers-2:0], granted_q};
    end
  end
  always_ff @(posedge clk_i) begin
    rd_addr_q <= rd_addr;
    data_q    <= rd_data_i;
    data_q2   <= data_q;
  end
  assign rd_valid_o = rd_valid_q;
  assign rd_addr_o  = rd_addr_q;

  // The right plane's rows have no first.
  /* verilator lint_off UNUSEDSIGNAL */
  logic [1:0] valid, first, incoming, leaving, busy;
  /* verilator lint_on UNUSEDSIGNAL */
  logic [1:0][1:0] ok;
  for (genvar n = 0; n < 2; n++) begin : g_plane
    slog_dense_stream #(
        .Width(Width),
        .AddrW(AddrW)
    ) u_stream (
        .clk_i,
        .rst_i,
        .start_i   (start_q[n]),
        .row_i     (row[n]),
        .mask_i    (plan_q.mask),
        .want_o    (want[2*n+:2]),
        .addr_o    (addr[2*n+:2]),
        .grant_i   (grant[2*n+:2]),
        .came_i    (asked_q[Answers-1][2*n+:2]),
        .data_i    (data_q2),
        .valid_o   (valid[n]),
        .first_o   (first[n]),
        .incoming_o(incoming[n]),
        .leaving_o (leaving[n]),
        .ok_o      (ok[n]),
        .busy_o    (busy[n])
    );
  end
  assign left_valid_o     = valid[0];
  assign first_o          = first[0];
  assign left_incoming_o  = incoming[0];
  assign left_leaving_o   = leaving[0];
  assign left_ok_o        = ok[0];
  assign right_valid_o    = valid[1];
  assign right_incoming_o = incoming[1];
  assign right_leaving_o  = leaving[1];
  assign right_ok_o       = ok[1];
  assign busy_o           = busy != '0;

  `SLOG_ASSERT(SlogDenseFeedRow, !(row_i && (waits_q != '0 || row_q != '0)))
  `SLOG_ASSERT(SlogDenseFeedTurn, $onehot(turn_q))
  `SLOG_ASSERT(SlogDenseFeedBegin, !(begin_q && (row_i || waits_q != '0 || row_q != '0 || busy_o)))
  `SLOG_ASSERT(SlogDenseFeedConstant, !(row_q != '0 || waits_q != '0 || busy_o) ||
               {plan_i, down_i, width_i, height_i} == {plan_q, down_q, width, height})
  `SLOG_ASSERT_INIT(SlogDenseFeedLatency, Answers == 12)
endmodule : slog_dense_feed
