// Takes jobs in order, refuses bad ones, and loads the operands of the others from the store, ahead of the sequencer.
//
// A job passes: check (slog_job_check, slog_job_plan) -> ticket -> template rows into the free template bank -> search rows
// into the ring. The ticket goes out before loading; tpl_done_o and rows_written_o tell how far loading is. Ring rows are
// counted modulo twice the ring (counter bit RowW-1 is the wrap), from reset on, job after job.
//
//   clock  registers (read of a store word)
//   0      rd_valid_o, rd_addr_o
//   4      rd_data_i (slog_store_pkg::StoreLatency)
//   +A     wr_*_o, aligned (A = latency of slog_align: 4 at 64 bits)
//   +1     rows_written_o, tpl_done_o
// Latency    : job to ticket 12 clocks when a template bank is free, first read 1 clock after.
// Throughput : one store read a clock, without gaps in a row; a job takes 13 clocks plus its reads.
// Rules      : a row is loaded when the ring has room for it; the ring is filled to its last row.
//              slot_busy_o marks the slots of the present job from the clock after it is taken, which is when the check
//              looks at slot_valid_i, until its last read.
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
    output logic [1:0]       tpl_done_o,      // per bank: the template of its present job is there
    output logic [RowW-1:0]  rows_written_o,
    input  logic [RowW-1:0]  rows_freed_i,
    input  logic             bank_free_i,     // pulse: the older template bank is free again
    output logic             busy_o
);
  localparam int unsigned ShiftW = $clog2(Width);

  typedef enum logic [2:0] {Idle, Start, Check, Issue, Template, Search} state_e;
  typedef struct packed {
    logic [ShiftW-1:0] shift;
    logic              emit;      // an aligned word begins here
    logic              row_end;   // the last of its row
    logic              load_end;  // row_end of the last row
    logic              tpl;
    logic              wide;
    logic              bank;
    logic [7:0]        row;
    logic [3:0]        word;
  } side_t;

  state_e state_q;
  job_t job_q;

  // Check and plan.
  logic start, checked;
  status_e status;
  logic [ScoreW-1:0] area;
  // The address is as wide as the largest store's.
  /* verilator lint_off UNUSEDSIGNAL */
  load_t tpl_plan, search_plan;
  /* verilator lint_on UNUSEDSIGNAL */
  assign start = state_q == Start;
  slog_job_check #(
      .MinWindow(MinWindow),
      .MaxWindow(MaxWindow),
      .Slots    (Slots)
  ) u_check (
      .clk_i,
      .rst_i,
      .start_i (start),
      .job_i   (job_q),
      .image_width_i,
      .image_height_i,
      .slot_valid_i,
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
      .start_i (start),
      .job_i   (job_q),
      .tpl_o   (tpl_plan),
      .search_o(search_plan)
  );

  // Template banks: given out in turn, come back in turn.
  logic [1:0] banks_used_q;
  logic bank_q, wide_q;
  logic ticket_valid_q, issue, refused;
  ticket_t ticket_q;
  assign refused = status != StatusOk;
  assign issue   = state_q == Issue && !ticket_valid_q && (refused || !banks_used_q[1]);

  // The read under way.
  logic [AddrW-1:0] addr_q, line_q;  // next word; first word of its row
  logic [3:0] word_q, words_in_q, words_out_q;
  logic [9:0] rows_left_q;
  logic [ShiftW-1:0] shift_q;
  logic [7:0] tpl_row_q;
  logic [RowW-1:0] ring_q;           // ring rows given out, mod 2*RingRows
  logic [RowW-1:0] ring_next_q;      // ring_q + 1
  logic [RowW-1:0] limit_q;          // value of ring_q at which the ring is full
  logic full_q, loading_tpl, read, row_end, load_end;
  assign loading_tpl = state_q == Template;
  assign read        = loading_tpl || (state_q == Search && (word_q != '0 || !full_q));
  assign row_end     = read && word_q == words_in_q;
  assign load_end    = row_end && rows_left_q == '0;

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      state_q        <= Idle;
      slot_busy_o    <= '0;
      ticket_valid_q <= 1'b0;
      banks_used_q   <= '0;
      bank_q         <= 1'b1;
    end else begin
      if (ticket_ready_i) ticket_valid_q <= 1'b0;
      banks_used_q <= banks_used_q + 2'(issue && !refused) - 2'(bank_free_i);
      unique case (state_q)
        Idle:
        if (job_valid_i) begin
          state_q     <= Start;
          slot_busy_o <= (8'd1 << job_i.tpl_slot) | (8'd1 << job_i.search_slot);
        end
        Start: state_q <= Check;
        Check: if (checked) state_q <= Issue;
        Issue: begin
          if (issue) begin
            ticket_valid_q <= 1'b1;
            state_q        <= refused ? Idle : Template;
            if (!refused) bank_q <= !bank_q;
            if (refused) slot_busy_o <= '0;
          end
        end
        Template: if (load_end) state_q <= Search;
        Search:
        if (load_end) begin
          state_q     <= Idle;
          slot_busy_o <= '0;
        end
        default: state_q <= Idle;
      endcase
    end
  end

  always_ff @(posedge clk_i) begin
    if (state_q == Idle) job_q <= job_i;
    if (issue) begin
      ticket_q <= '{job: job_q, status: status, bank: !bank_q, row: 9'(ring_q), area: area};
      wide_q   <= job_q.width > 8'(Width);
    end
  end

  // Walk through the rectangle.
  always_ff @(posedge clk_i) begin
    if (issue || (loading_tpl && load_end)) begin
      addr_q      <= issue ? tpl_plan.addr[AddrW-1:0] : search_plan.addr[AddrW-1:0];
      line_q      <= issue ? tpl_plan.addr[AddrW-1:0] : search_plan.addr[AddrW-1:0];
      shift_q     <= issue ? tpl_plan.shift[ShiftW-1:0] : search_plan.shift[ShiftW-1:0];
      words_in_q  <= issue ? tpl_plan.words_in : search_plan.words_in;
      words_out_q <= issue ? tpl_plan.words_out : search_plan.words_out;
      rows_left_q <= issue ? tpl_plan.rows : search_plan.rows;
      word_q      <= '0;
      tpl_row_q   <= '0;
    end else if (read) begin
      addr_q <= row_end ? line_q + AddrW'(WordsPerRow) : addr_q + 1'b1;
      word_q <= row_end ? '0 : word_q + 1'b1;
      if (row_end) begin
        line_q      <= line_q + AddrW'(WordsPerRow);
        rows_left_q <= rows_left_q - 1'b1;
        tpl_row_q   <= tpl_row_q + 1'b1;
      end
    end
  end

  // Room in the ring, up to limit_q: free rows are known a clock or two late, never early.
  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      ring_q      <= '0;
      ring_next_q <= RowW'(1);
      limit_q     <= RowW'(RingRows);
      full_q      <= 1'b0;
    end else begin
      if (row_end && !loading_tpl) begin
        ring_q      <= ring_next_q;
        ring_next_q <= ring_next_q + 1'b1;
      end
      limit_q <= rows_freed_i + RowW'(RingRows);
      full_q  <= (row_end && !loading_tpl) ? ring_next_q == limit_q : ring_q == limit_q;
    end
  end

  // What goes along with a word from the store read to the operand write.
  logic [StoreLatency:0] read_q;
  side_t side_q[StoreLatency+1];
  logic [AddrW-1:0] rd_addr_q;
  always_ff @(posedge clk_i) begin
    if (rst_i) read_q <= '0;
    else read_q <= {read_q[StoreLatency-1:0], read};
  end
  always_ff @(posedge clk_i) begin
    if (read) begin
      rd_addr_q <= addr_q;
      side_q[0] <= '{
          shift: shift_q,
          emit: word_q <= words_out_q,
          row_end: word_q == words_out_q,
          load_end: rows_left_q == '0,
          tpl: loading_tpl,
          wide: wide_q,
          bank: bank_q,
          row: loading_tpl ? tpl_row_q : 8'(ring_q[RowW-2:0]),
          word: word_q
      };
    end
    for (int unsigned s = 1; s <= StoreLatency; s++) if (read_q[s-1]) side_q[s] <= side_q[s-1];
  end

  // The shift has done its work by the end.
  /* verilator lint_off UNUSEDSIGNAL */
  side_t wr_side;
  /* verilator lint_on UNUSEDSIGNAL */
  slog_align #(
      .Width(Width),
      .SideW($bits(side_t))
  ) u_align (
      .clk_i,
      .rst_i,
      .in_valid_i (read_q[StoreLatency]),
      .in_emit_i  (side_q[StoreLatency].emit),
      .in_data_i  (rd_data_i),
      .in_shift_i (side_q[StoreLatency].shift),
      .in_side_i  (side_q[StoreLatency]),
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
      if (issue && !refused) tpl_done_q[!bank_q] <= 1'b0;
    end
  end

  assign job_ready_o    = state_q == Idle;
  assign rd_valid_o     = read_q[0];
  assign rd_addr_o      = rd_addr_q;
  assign wr_tpl_o       = wr_side.tpl;
  assign wr_wide_o      = wr_side.wide;
  assign wr_bank_o      = wr_side.bank;
  assign wr_row_o       = wr_side.row;
  assign wr_word_o      = wr_side.word;
  assign ticket_valid_o = ticket_valid_q;
  assign ticket_o       = ticket_q;
  assign tpl_done_o     = tpl_done_q;
  assign rows_written_o = rows_written_q;
  assign busy_o         = state_q != Idle || ticket_valid_q;

  `SLOG_ASSERT_INIT(SlogFetchRing, RingRows == 2 ** (RowW - 1) && RingRows >= MaxWindow && RingRows <= 256)
  `SLOG_ASSERT_STABLE(SlogFetchTicketStable, ticket_valid_o, ticket_ready_i, ticket_o)
  `SLOG_ASSERT(SlogFetchRingNotOverrun, RowW'(ring_q - rows_freed_i) <= RowW'(RingRows))
  `SLOG_ASSERT(SlogFetchBanks, banks_used_q != 2'd3 && !(bank_free_i && banks_used_q == '0))
endmodule : slog_fetch
