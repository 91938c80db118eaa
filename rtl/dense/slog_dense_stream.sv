// SPDX-License-Identifier: Apache-2.0
// Sends one plane's rows to the dense engine: of each column the bit of the row that comes into the windows and of the row
// that leaves them, from words that are read just in time.
//
// Of each word of a row both rows' words are asked for when its first column is due in Ahead clocks. What has been asked for
// is read within four clocks, comes into the next register in time, and goes into the hold register when its turn has come.
// No word waits anywhere else, because the store answers after a fixed time.
//
// Stage  registers                      clocks after column's turn
//   0    row_q, row_left_q, ...         row_i, one clock before start_i
//        run_q                          0: the column's turn; the first one's is 1 clock after start_i
//   1    want_o addr_o                  1: of a word's first column; grant_i 1 to 4; the next address 2 clocks after it
//   2    next_q                         up to Ahead: came_i with data_i is Answer clocks after the grant
//   3    token_q                        1..Ahead
//   4    hold_q and the outputs         Ahead + 1
// Latency    : start_i to the row's first column Ahead + 2 = 20 clocks.
// Throughput : a column per clock.
// Rules      : start_i comes 5 clocks or more after a row's last column's turn. A wish is granted within 4 clocks. row_i
//              counts in the clock before start_i; a row has one column or more besides those it skips. mask_i is constant
//              in a pass.
// Formats    : bit 0 of a word is the leftmost pixel. valid_o: a column that is not skipped. ok_o: row_i.ok in columns from
//              window - 1 on, else 0.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_dense_stream
  import slog_dense_pkg::*;
#(
    parameter int unsigned Width = 64,
    parameter int unsigned AddrW = 14
) (
    input  logic                        clk_i,
    input  logic                        rst_i,
    input  logic                        start_i,
    input  row_t                        row_i,
    input  logic [      9:0]            mask_i,
    output logic [      1:0]            want_o,      // [0] the row that comes in, [1] the one that leaves
    output logic [      1:0][AddrW-1:0] addr_o,
    input  logic [      1:0]            grant_i,     // only with want_o
    input  logic [      1:0]            came_i,
    input  logic [Width-1:0]            data_i,
    output logic                        valid_o,
    output logic                        first_o,
    output logic                        incoming_o,
    output logic                        leaving_o,
    output logic [      1:0]            ok_o,
    output logic                        busy_o       // a row of two columns or more is under way
);
  localparam int unsigned Ahead = 18;
  localparam int unsigned BitW  = $clog2(Width);
  localparam int unsigned Parts = (Ahead + 4) / 4;

  typedef struct packed {
    logic       run;
    logic       load;   // the first column of a word
    logic       sent;   // not skipped
    logic       first;
    logic [1:0] ok;
    logic [1:0] has;
  } token_t;

  // What a row begins with, computed before its start.
  row_t row_q;
  logic [9:0] row_after_q;
  logic [BitW:0] row_skip_q;
  logic [10:0] row_left_q;

  logic run_q, first_q;
  logic [BitW-1:0] bit_q;               // of the column in its word
  logic begins_q;                       // bit_q == 0
  logic [9:0] after_q;                  // column + 1
  logic [BitW:0] skip_q;                // columns to skip, less one: negative when none is left
  logic [10:0] left_q;                  // columns after this one, less one: negative at the last
  logic skips, last;
  logic [1:0] ok_q, has_q, want_q, granted_q;
  logic [1:0][AddrW-1:0] addr_q;
  logic [1:0][Width-1:0] next_q, hold_q;
  token_t token_q[Ahead];
  token_t now;
  logic [4*Parts-1:0] under_way;        // the column in turn, and those after it on their way
  logic [Parts-1:0] some_q;             // of four of these, any
  logic valid_q, busy_q, any_q, first_q2;
  logic [1:0] ok_q2;

  assign now   = token_q[Ahead-1];
  assign skips = !skip_q[BitW];
  assign last  = left_q[10];
  always_comb begin
    under_way = (4 * Parts)'(run_q);
    for (int unsigned n = 0; n < Ahead; n++) under_way[n+1] = token_q[n].run;
  end

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      run_q   <= 1'b0;
      want_q  <= '0;
      granted_q <= '0;
      valid_q <= 1'b0;
      busy_q  <= 1'b0;
      some_q  <= '0;
      any_q   <= 1'b0;
      for (int unsigned n = 0; n < Ahead; n++) token_q[n].run <= 1'b0;
    end else begin
      run_q   <= start_i || (run_q && !last);
      for (int unsigned n = 0; n < 2; n++) begin
        want_q[n] <= (run_q && begins_q && has_q[n]) || (want_q[n] && !grant_i[n]);
      end
      granted_q <= grant_i;
      valid_q <= now.run && now.sent;
      busy_q  <= start_i || run_q || any_q;
      any_q   <= some_q != '0;
      for (int unsigned n = 0; n < Parts; n++) some_q[n] <= under_way[4*n+:4] != '0;
      token_q[0].run <= run_q;
      for (int unsigned n = 1; n < Ahead; n++) token_q[n].run <= token_q[n-1].run;
    end
  end

  always_ff @(posedge clk_i) begin
    row_q       <= row_i;
    row_after_q <= row_i.column + 1'b1;
    row_skip_q  <= (BitW + 1)'(row_i.skip) - 1'b1;
    row_left_q  <= 11'(row_i.count) - 11'd2;
    if (start_i) begin
      first_q  <= row_q.first;
      bit_q    <= '0;
      begins_q <= 1'b1;
      after_q  <= row_after_q;
      skip_q   <= row_skip_q;
      left_q   <= row_left_q;
      ok_q     <= row_q.ok;
      has_q    <= {row_q.has_leaving, row_q.has_incoming};
    end else begin  // run_q, or nobody looks
      bit_q    <= bit_q + 1'b1;
      begins_q <= bit_q == '1;
      after_q  <= after_q + 1'b1;
      if (skips) skip_q <= skip_q - 1'b1;
      left_q   <= left_q - 1'b1;
    end
    for (int unsigned n = 0; n < 2; n++) begin
      if (start_i) addr_q[n] <= AddrW'(n == 0 ? row_q.incoming : row_q.leaving);
      else if (granted_q[n]) addr_q[n] <= addr_q[n] + 1'b1;
      if (came_i[n]) next_q[n] <= data_i;
      hold_q[n] <= !now.load ? hold_q[n] >> 1 : now.has[n] ? next_q[n] : '0;
    end
    token_q[0].load  <= begins_q;
    token_q[0].sent  <= !skips;
    token_q[0].first <= first_q;
    token_q[0].ok    <= (after_q & mask_i) != '0 ? ok_q : '0;
    token_q[0].has   <= has_q;
    for (int unsigned n = 1; n < Ahead; n++) begin
      token_q[n].load  <= token_q[n-1].load;
      token_q[n].sent  <= token_q[n-1].sent;
      token_q[n].first <= token_q[n-1].first;
      token_q[n].ok    <= token_q[n-1].ok;
      token_q[n].has   <= token_q[n-1].has;
    end
    first_q2 <= now.first;
    ok_q2    <= now.ok;
  end

  assign want_o     = want_q;
  assign addr_o     = addr_q;
  assign valid_o    = valid_q;
  assign first_o    = first_q2;
  assign incoming_o = hold_q[0][0];
  assign leaving_o  = hold_q[1][0];
  assign ok_o       = ok_q2;
  assign busy_o     = busy_q;

  `SLOG_ASSERT_INIT(SlogDenseStreamWidth, Width == 2 ** BitW && Width >= 4 && AddrW <= 16)
  `SLOG_ASSERT(SlogDenseStreamApart, !(start_i && (run_q || want_q != '0)))
  `SLOG_ASSERT(SlogDenseStreamRow, !start_i || (row_q.count > row_q.skip && 32'(row_q.column) % Width == 0 &&
               32'(row_q.skip) < Width))
  `SLOG_ASSERT(SlogDenseStreamBegins, !run_q || begins_q == (bit_q == '0))
  `SLOG_ASSERT(SlogDenseStreamGrant, (grant_i & ~want_q) == '0)
`ifndef SYNTHESIS
  logic [1:0] here_q;  // a word is in the next register that has not been held yet
  always_ff @(posedge clk_i) begin
    if (rst_i) here_q <= '0;
    else here_q <= came_i | (here_q & ~{2{now.run && now.load}});
  end
`endif
  // Every word is there when its turn comes, and none is overwritten before it.
  `SLOG_ASSERT(SlogDenseStreamInTime, !(now.run && now.load) || here_q == now.has)
  `SLOG_ASSERT(SlogDenseStreamKept, (came_i & here_q) == '0 || (now.run && now.load))
endmodule : slog_dense_stream
