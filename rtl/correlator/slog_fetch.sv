// SPDX-License-Identifier: Apache-2.0
// Takes jobs in order, refuses bad ones, and loads the operands of the others from the store, ahead of the sequencer.
//
// Sequence of a job: check (slog_job_check, slog_job_plan) -> ticket -> template rows into the free template bank ->
// search rows into the ring. The ticket is offered before loading; tpl_done_o and rows_written_o show the progress of
// loading. Ring rows are counted modulo 2*RingRows (counter bit RowW-1 is the wrap bit), from reset on, over all jobs.
//
//   clock  registers (read of a store word)
//   -2     line_q, tpl_row_q: row of the word
//   -1     rd_addr_q
//   0      rd_valid_o, rd_addr_o
//   S      rd_data_i (S = slog_store_pkg::StoreLatency)
//   +1     data_q
//   +A     wr_*_o: the aligned word (A = latency of slog_align: 5 at 64 bits)
//   +1     rows_written_o, tpl_done_o
// Latency    : from job to ticket 14 clocks when a template bank is free; the first read 4 clocks after the ticket.
// Throughput : one store read per clock, without gaps in a row or between rows; a job takes 20 clocks plus its reads.
// Rules      : a row is loaded as soon as the ring has room for it; all rows of the ring are used.
//              slot_busy_o marks the slots of the present job from the second clock after the job is taken (when the
//              check reads slot_valid_i as registered in the clock before) until after its last read.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_fetch
  import slog_pkg::*, slog_fetch_pkg::*, slog_store_pkg::*;
#(
    parameter  int unsigned Width       = 64,
    parameter  int unsigned MaxHeight   = 480,
    parameter  int unsigned WordsPerRow = 10,
    parameter  int unsigned Slots       = 6,
    parameter  int unsigned MinWindow   = 8,
    parameter  int unsigned MaxWindow   = 128,
    parameter  int unsigned RingRows    = 256,
    localparam int unsigned AddrW       = $clog2(Slots * MaxHeight * WordsPerRow),
    localparam int unsigned RowW        = $clog2(RingRows) + 1
) (
    input  logic             clk_i,
    input  logic             rst_i,
    input  logic             job_valid_i,
    output logic             job_ready_o,
    input  job_t             job_i,
    input  logic [9:0]       image_width_i,
    input  logic [9:0]       image_height_i,
    input  logic [7:0]       slot_valid_i,
    output logic [7:0]       slot_busy_o,
    output logic             rd_valid_o,
    output logic [AddrW-1:0] rd_addr_o,
    input  logic [Width-1:0] rd_data_i,
    output logic             wr_valid_o,
    output logic             wr_tpl_o,    // 1 template, 0 search
    output logic             wr_wide_o,
    output logic             wr_bank_o,
    output logic [7:0]       wr_row_o,    // template row, or ring row
    output logic [3:0]       wr_word_o,
    output logic [Width-1:0] wr_data_o,
    output logic             ticket_valid_o,
    input  logic             ticket_ready_i,
    output ticket_t          ticket_o,
    output logic [1:0]       tpl_done_o,      // per bank: the template of its present job is loaded
    output logic [RowW-1:0]  rows_written_o,
    input  logic [RowW-1:0]  rows_freed_i,
    input  logic             bank_free_i,     // pulse: the older template bank is free again
    output logic             busy_o
);
  localparam int unsigned ShiftW = $clog2(Width);

  typedef struct packed {
    logic [ShiftW-1:0] shift;
    logic              emit;      // an aligned word begins here
    logic              row_end;   // last word of its row
    logic              load_end;  // row_end of the last row
    logic              tpl;
    logic              wide;
    logic              bank;
    logic [7:0]        row;
    logic [3:0]        word;
  } side_t;

  // One-hot state, in order: idle; mark the job's slots; start check and plan; wait for their results; wait until the
  // ticket register and a bank are free; fill the ticket; read the template; load the search's plan; read the search
  // rows; done.
  logic idle_q, mark_q, start_q, check_q, wait_q, issue_q, tpl_q, turn_q, search_q, over_q;
  logic held_q;                      // !idle_q, a copy for the enables of job_q
  job_t job_q;

  // Check and plan.
  logic checked;
  logic [7:0] slot_valid_q;
  always_ff @(posedge clk_i) slot_valid_q <= slot_valid_i;
  status_e status;
  logic [ScoreW-1:0] area;
  // The address is as wide as the largest store's.
  /* verilator lint_off UNUSEDSIGNAL */
  load_t tpl_plan, search_plan;
  /* verilator lint_on UNUSEDSIGNAL */
  slog_job_check #(
      .MinWindow(MinWindow),
      .MaxWindow(MaxWindow),
      .Slots    (Slots)
  ) u_check (
      .clk_i,
      .rst_i,
      .start_i (start_q),
      .job_i   (job_q),
      .image_width_i,
      .image_height_i,
      .slot_valid_i(slot_valid_q),
      .done_o  (checked),
      .status_o(status),
      .area_o  (area)
  );
  slog_job_plan #(
      .Width      (Width),
      .MaxHeight  (MaxHeight),
      .WordsPerRow(WordsPerRow)
  ) u_plan (
      .clk_i,
      .rst_i,
      .start_i (start_q),
      .job_i   (job_q),
      .tpl_o   (tpl_plan),
      .search_o(search_plan)
  );

  // Template banks: allocated and freed in alternation.
  logic [1:0] banks_used_q;
  logic [7:0] width_q;               // job_q.width, pipeline register
  logic bank_q, broad_q, wide_q, ticket_valid_q, refused_q, accept, refuse;
  logic accept_q, refuse_q;          // issue_q for an accepted, a refused job
  ticket_t ticket_q;
  assign accept = wait_q && !ticket_valid_q && !refused_q && !banks_used_q[1];
  assign refuse = wait_q && !ticket_valid_q && refused_q;

  // The present read: word word_q of its row; line_q, one clock later, is the row's first store address. Loading a
  // rectangle's plan (take_q) and starting its first row (one clock later) use the same logic as the end of a row:
  // step_q is high in these two clocks and when a word is read. Between rectangles last_q and last_row_q are high and
  // the other registers here are don't-care.
  logic take_q, walk_q, step_q, active_q;  // walk_q: !take_q, a copy for the counters
  logic end_q;                       // the rectangle's last word was read in the clock before
  logic go_q;                        // a word is read in this clock
  logic last_q, last_row_q;          // the word is the last of its row; the row is the last of its rectangle
  logic more_q;                      // !last_q, a copy for the flags
  logic [AddrW-1:0] line_q, next_line_q;
  logic [3:0] word_q, left_q, words_in_q, words_out_q;
  logic spare_q;                     // a row touches one store word more than it fills aligned words
  logic [9:0] rows_left_q;           // rows after the next row
  logic [ShiftW-1:0] shift_q;
  logic [7:0] tpl_row_q;             // template row of the read in the clock before
  logic [RowW-1:0] ring_q;           // ring rows allocated, mod 2*RingRows
  logic next_row_q, walk_q2, turn_q2;  // one clock late: addresses and template rows are needed one clock later
  logic last, next_row, given, rect_end, go, blocked, next_blocked;
  assign next_row = step_q && last_q;
  assign given    = go_q && last_q && search_q;
  // The lowest SameW bits of the address are the same in all rows of a rectangle: they are loaded with its plan only.
  localparam int unsigned SameW = $clog2(WordsPerRow & -WordsPerRow);
  logic [AddrW-1:0] next_line;
  assign next_line = walk_q2 ? next_line_q + AddrW'(WordsPerRow) :
                     turn_q2 ? search_plan.addr[AddrW-1:0] : tpl_plan.addr[AddrW-1:0];
  assign rect_end = go_q && last_q && last_row_q;
  assign last     = !step_q ? last_q : last_q ? last_row_q || words_in_q == '0 : left_q == 4'd1;
  assign go       = go_q ? more_q || !(last_row_q || next_blocked) : active_q && !blocked;

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      idle_q         <= 1'b1;
      held_q         <= 1'b0;
      mark_q         <= 1'b0;
      start_q        <= 1'b0;
      check_q        <= 1'b0;
      wait_q         <= 1'b0;
      issue_q        <= 1'b0;
      tpl_q          <= 1'b0;
      turn_q         <= 1'b0;
      search_q       <= 1'b0;
      over_q         <= 1'b0;
      accept_q       <= 1'b0;
      refuse_q       <= 1'b0;
      take_q         <= 1'b0;
      walk_q         <= 1'b1;
      step_q         <= 1'b0;
      active_q       <= 1'b0;
      end_q          <= 1'b0;
      last_q         <= 1'b1;
      more_q         <= 1'b0;
      last_row_q     <= 1'b1;
      go_q           <= 1'b0;
      slot_busy_o    <= '0;
      ticket_valid_q <= 1'b0;
      banks_used_q   <= '0;
      bank_q         <= 1'b1;
    end else begin
      idle_q   <= (idle_q && !job_valid_i) || refuse_q || over_q;
      held_q   <= !((idle_q && !job_valid_i) || refuse_q || over_q);
      mark_q   <= idle_q && job_valid_i;
      start_q  <= mark_q;
      check_q  <= start_q || (check_q && !checked);
      wait_q   <= (check_q && checked) || (wait_q && !accept && !refuse);
      issue_q  <= accept || refuse;
      accept_q <= accept;
      refuse_q <= refuse;
      tpl_q    <= accept_q || (tpl_q && !end_q);
      turn_q   <= tpl_q && end_q;
      search_q <= turn_q || (search_q && !end_q);
      over_q   <= search_q && end_q;
      take_q   <= accept || (tpl_q && end_q);
      active_q <= take_q || (active_q && !rect_end);
      end_q    <= rect_end;
      go_q     <= go;
      walk_q   <= !(accept || (tpl_q && end_q));
      step_q   <= accept || end_q || take_q || go;
      last_q   <= last;
      more_q   <= !last;
      for (int unsigned s = 0; s < 8; s++) begin
        slot_busy_o[s] <= !idle_q && (job_q.tpl_slot == 3'(s) || job_q.search_slot == 3'(s));
      end
      ticket_valid_q <= issue_q || (ticket_valid_q && !ticket_ready_i);
      banks_used_q   <= banks_used_q + 2'(accept_q) - 2'(bank_free_i);
      if (accept_q) bank_q <= !bank_q;
      last_row_q     <= !take_q && (last_row_q || (step_q && !more_q && rows_left_q == '0));
    end
  end

  always_ff @(posedge clk_i) begin
    if (!held_q) job_q <= job_i;
    refused_q <= status != StatusOk;
    width_q   <= job_q.width;
    broad_q   <= width_q > 8'(Width);
    if (issue_q) begin
      ticket_q <= '{job: job_q, status: status, bank: !bank_q, row: 9'(ring_q), area: area};
      wide_q   <= broad_q;
    end
  end

  // Walk through the rectangle.
  always_ff @(posedge clk_i) begin
    if (!walk_q) begin
      shift_q     <= turn_q ? search_plan.shift[ShiftW-1:0] : tpl_plan.shift[ShiftW-1:0];
      words_in_q  <= turn_q ? search_plan.words_in : tpl_plan.words_in;
      words_out_q <= turn_q ? search_plan.words_out : tpl_plan.words_out;
    end
    spare_q <= words_in_q != words_out_q;
    if (step_q) begin
      word_q <= last_q ? '0 : word_q + 1'b1;
      left_q <= last_q ? words_in_q : left_q - 1'b1;
    end
    if (next_row) rows_left_q <= walk_q ? rows_left_q - 1'b1 : turn_q ? search_plan.rows : tpl_plan.rows;
    next_row_q <= next_row;
    walk_q2    <= walk_q;
    turn_q2    <= turn_q;
    if (next_row_q) line_q <= next_line_q;
    for (int unsigned b = 0; b < AddrW; b++) if ((b < SameW) ? !walk_q2 : next_row_q) next_line_q[b] <= next_line[b];
    if (!walk_q2) tpl_row_q <= '1;
    else if (next_row_q) tpl_row_q <= tpl_row_q + 1'b1;
  end

  // Room in the ring: freed rows count a few clocks late, never early. The comparisons are registered, so they are also
  // made for one and two rows more: full_q[n] is high if, in the clock before, n more rows would have filled the ring.
  logic [RowW-1:0] limit_q[3];      // [n]: value of ring_q at which the ring has room for n rows
  logic [2:0] full_q;
  logic given_q;                    // a ring row was allocated in the clock before
  assign blocked      = search_q && (given_q ? full_q[1] : full_q[0]);
  assign next_blocked = search_q && (given_q ? full_q[2] : full_q[1]);
  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      ring_q  <= '0;
      given_q <= 1'b0;
      full_q  <= '0;
      for (int unsigned n = 0; n < 3; n++) limit_q[n] <= RowW'(RingRows - n);
    end else begin
      given_q <= given;
      if (given) ring_q <= ring_q + 1'b1;
      for (int unsigned n = 0; n < 3; n++) begin
        limit_q[n] <= rows_freed_i + RowW'(RingRows - n);
        full_q[n]  <= ring_q == limit_q[n];
      end
    end
  end

  // Side data delayed to match its word, from the read to the operand write. The first stages compute the address.
  localparam int unsigned Asked = 2;  // stage of the store read in read_q
  localparam int unsigned Came  = Asked + StoreLatency + 1;
  logic [Came:0] read_q;
  side_t side_q[Came+1];
  logic [AddrW-1:0] rd_addr_q, rd_addr_q2;
  logic [Width-1:0] data_q;
  always_ff @(posedge clk_i) begin
    if (rst_i) read_q <= '0;
    else read_q <= {read_q[Came-1:0], go_q};
  end
  always_ff @(posedge clk_i) begin
    data_q     <= rd_data_i;
    rd_addr_q  <= line_q + AddrW'(side_q[0].word);
    rd_addr_q2 <= rd_addr_q;
    side_q[0] <= '{
        shift: shift_q,
        emit: !(last_q && spare_q),
        row_end: spare_q ? left_q == 4'd1 : last_q,
        load_end: last_row_q,
        tpl: tpl_q,
        wide: wide_q,
        bank: bank_q,
        row: 8'(ring_q[RowW-2:0]),
        word: word_q
    };
    // The stage after the store read has no enable: read_q[Asked] already drives rd_valid_o.
    for (int unsigned s = 1; s <= Came; s++) if (s == Asked + 1 || read_q[s-1]) side_q[s] <= side_q[s-1];
    if (read_q[0] && side_q[0].tpl) side_q[1].row <= tpl_row_q;
  end

  // The shift is not used after the alignment.
  /* verilator lint_off UNUSEDSIGNAL */
  side_t wr_side;
  /* verilator lint_on UNUSEDSIGNAL */
  slog_align #(
      .Width(Width),
      .SideW($bits(side_t))
  ) u_align (
      .clk_i,
      .rst_i,
      .in_valid_i (read_q[Came]),
      .in_emit_i  (side_q[Came].emit),
      .in_data_i  (data_q),
      .in_shift_i (side_q[Came].shift),
      .in_side_i  (side_q[Came]),
      .out_valid_o(wr_valid_o),
      .out_data_o (wr_data_o),
      .out_side_o (wr_side)
  );

  // Progress.
  logic [RowW-1:0] rows_written_q;
  logic [1:0] tpl_done_q;
  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      rows_written_q <= '0;
      tpl_done_q     <= '0;
    end else begin
      if (wr_valid_o && !wr_side.tpl && wr_side.row_end) rows_written_q <= rows_written_q + 1'b1;
      if (wr_valid_o && wr_side.tpl && wr_side.row_end && wr_side.load_end) tpl_done_q[wr_side.bank] <= 1'b1;
      if (accept_q) tpl_done_q[!bank_q] <= 1'b0;
    end
  end

  assign job_ready_o    = idle_q;
  assign rd_valid_o     = read_q[Asked];
  assign rd_addr_o      = rd_addr_q2;
  assign wr_tpl_o       = wr_side.tpl;
  assign wr_wide_o      = wr_side.wide;
  assign wr_bank_o      = wr_side.bank;
  assign wr_row_o       = wr_side.row;
  assign wr_word_o      = wr_side.word;
  assign ticket_valid_o = ticket_valid_q;
  assign ticket_o       = ticket_q;
  assign tpl_done_o     = tpl_done_q;
  assign rows_written_o = rows_written_q;
  assign busy_o         = !idle_q || ticket_valid_q;

  `SLOG_ASSERT(SlogFetchState,
               $onehot({idle_q, mark_q, start_q, check_q, wait_q, issue_q, tpl_q, turn_q, search_q, over_q}))
  `SLOG_ASSERT(SlogFetchCopies, more_q == !last_q && walk_q == !take_q && held_q == !idle_q)
  `SLOG_ASSERT(SlogFetchBetween, active_q || take_q || (last_q && last_row_q && !go_q))
  `SLOG_ASSERT_INIT(SlogFetchRing, RingRows == 2 ** (RowW - 1) && RingRows >= MaxWindow && RingRows <= 256)
  `SLOG_ASSERT_STABLE(SlogFetchTicketStable, ticket_valid_o, ticket_ready_i, ticket_o)
  `SLOG_ASSERT(SlogFetchRingNotOverrun, RowW'(ring_q - rows_freed_i) <= RowW'(RingRows))
  `SLOG_ASSERT(SlogFetchBanks, banks_used_q != 2'd3 && !(bank_free_i && banks_used_q == '0))
  `SLOG_ASSERT(SlogFetchSlotBusy, !rd_valid_o || slot_busy_o[3'(32'(rd_addr_o) / (MaxHeight * WordsPerRow))])
endmodule : slog_fetch
