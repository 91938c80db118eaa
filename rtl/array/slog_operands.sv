// SPDX-License-Identifier: Apache-2.0
// Holds the correlator array's operands, two templates and a ring of search rows, and reads a row of both per clock.
//
//   tpl_a = template row s, tpl_b = template row s+1, s = 2*tpl_step; search rows ring_row and the next    (paired)
//   tpl_a = low, tpl_b = high word of template row tpl_step; search row ring_row, its low and high part    (wide)
//
// Stage   registers            valid after the clock of step_i
//   1-2   step_q, step_q2      1, 2: pipeline registers for the distance from the walker
//   3-6   tpl_addr_q .. q4     3 .. 6: delay, because templates take fewer stages than search rows
//   8     template RAM output  8
//   9     tpl_*_o, search_*_o, valid_o .. lanes_o, move_o    9 = slog_array_pkg::OperandLatency
// A word to be written passes three registers: two on its way, as the step does, and one at its destination (the ring's
// even rows, its odd rows, or the templates).
//
// Throughput : one step and one written word per clock.
// Formats    : bit 0 is leftmost; search rows start at unit step_i.chunk of the ring row (units of GroupBits/2 bits).
// Rules      : both groups are 0 while valid_o is low, group B also while row_b_o is low (its row does not exist), from
//              the second clock after reset on. A step may read a word slog_array_pkg::WriteLatency clocks after the
//              word's wr_valid_i, and the word may be overwritten slog_array_pkg::ReuseClocks after the last such step.
//              step_i.lanes 1..Lanes; rows lie within the ring or the template. move_o stays high for
//              slog_array_pkg::hold_clocks after valid_o; then it falls if HoldIdle is set, and the array holds.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_operands #(
    parameter  int unsigned GroupBits   = 8,
    parameter  int unsigned Lanes       = GroupBits / 2 + 1,
    parameter  int unsigned RingRows    = 32,
    parameter  int unsigned WordsPerRow = 6,
    parameter  bit          HoldIdle    = 1'b1,
    localparam int unsigned SearchBits  = GroupBits + Lanes - 1,
    localparam int unsigned LaneW       = $clog2(Lanes + 1)
) (
    input  logic                  clk_i,
    input  logic                  rst_i,
    input  logic                  wr_valid_i,
    input  logic                  wr_tpl_i,
    input  logic                  wr_wide_i,
    input  logic                  wr_bank_i,
    input  logic [7:0]            wr_row_i,
    input  logic [3:0]            wr_word_i,
    input  logic [GroupBits-1:0]  wr_data_i,
    input  slog_pkg::step_t       step_i,
    output logic                  move_o,
    output logic                  valid_o,
    output logic                  first_o,
    output logic                  last_o,
    output logic                  row_b_o,
    output logic [LaneW-1:0]      lanes_o,
    output logic [GroupBits-1:0]  tpl_a_o,
    output logic [GroupBits-1:0]  tpl_b_o,
    output logic [SearchBits-1:0] search_a_o,
    output logic [SearchBits-1:0] search_b_o
);
  localparam int unsigned StepW      = $clog2(2 * GroupBits);
  localparam int unsigned RingW      = $clog2(RingRows);
  localparam int unsigned HoldClocks = slog_array_pkg::hold_clocks(GroupBits, Lanes);
  localparam int unsigned HoldW      = $clog2(HoldClocks + 1);

  `SLOG_ASSERT_INIT(SlogOperandsLanes, 2 * (Lanes - 1) == GroupBits)
  `SLOG_ASSERT_INIT(SlogOperandsRing, 2 ** RingW == RingRows && RingW <= 8 && WordsPerRow <= 16)

  // Pipeline registers: the step, and a word to be written.
  typedef struct packed {
    logic                 valid;
    logic                 tpl;
    logic                 wide;
    logic                 bank;
    logic [7:0]           row;
    logic [3:0]           word;
    logic [GroupBits-1:0] data;
  } write_t;
  slog_pkg::step_t step_q, step_q2;
  write_t write_q;
  always_ff @(posedge clk_i) begin
    step_q  <= step_i;
    step_q2 <= step_q;
    if (rst_i) begin
      step_q.valid  <= 1'b0;
      step_q2.valid <= 1'b0;
    end
    write_q <= '{valid: wr_valid_i, tpl: wr_tpl_i, wide: wr_wide_i, bank: wr_bank_i, row: wr_row_i, word: wr_word_i,
                 data: wr_data_i};
  end

  // The memory and address to which the word is written.
  logic                 wr_even_q, wr_odd_q, wr_tpl_q, wr_high_q;
  logic [StepW:0]       wr_addr_q;
  logic [RingW-2:0]     wr_pair_q;
  logic [3:0]           wr_word_q;
  logic [GroupBits-1:0] wr_data_q;
  always_ff @(posedge clk_i) begin
    wr_even_q <= write_q.valid && !write_q.tpl && !write_q.row[0];
    wr_odd_q  <= write_q.valid && !write_q.tpl && write_q.row[0];
    wr_tpl_q  <= write_q.valid && write_q.tpl;
    wr_high_q <= write_q.wide ? write_q.word[0] : write_q.row[0];
    wr_addr_q <= {write_q.bank, write_q.wide ? write_q.row[StepW-1:0] : StepW'(write_q.row[StepW-1:1])};
    wr_pair_q <= write_q.row[RingW-1:1];
    wr_word_q <= write_q.word;
    wr_data_q <= write_q.data;
  end

  // Control bits delayed to match the operands, and the templates' addresses.
  typedef struct packed {
    logic             valid;
    logic             first;
    logic             last;
    logic             row_b;
    logic [LaneW-1:0] lanes;
  } control_t;
  control_t control_q, control_q2, control_q3, control_q4, control_q5, control_q6, control_q7;
  // The memories are far from the array, so they have a separate copy of valid and row_b: inverted, so that synthesis
  // does not merge it with control_q. A bit set to 1 blanks the group.
  logic [4:0] blank_a_q, blank_b_q;
  logic [StepW:0] tpl_addr_q, tpl_addr_q2, tpl_addr_q3, tpl_addr_q4;

  always_ff @(posedge clk_i) begin
    control_q  <= '{valid: step_q2.valid, first: step_q2.first, last: step_q2.last, row_b: step_q2.row_b,
                    lanes: step_q2.lanes[LaneW-1:0]};
    control_q2 <= control_q;
    control_q3 <= control_q2;
    control_q4 <= control_q3;
    control_q5 <= control_q4;
    control_q6 <= control_q5;
    control_q7 <= control_q6;
    blank_a_q  <= {blank_a_q[3:0], !step_q2.valid};
    blank_b_q  <= {blank_b_q[3:0], !(step_q2.valid && step_q2.row_b)};
    if (rst_i) begin
      blank_a_q        <= '1;
      blank_b_q        <= '1;
      control_q.valid  <= 1'b0;
      control_q2.valid <= 1'b0;
      control_q3.valid <= 1'b0;
      control_q4.valid <= 1'b0;
      control_q5.valid <= 1'b0;
      control_q6.valid <= 1'b0;
      control_q7.valid <= 1'b0;
    end
    tpl_addr_q  <= {step_q2.bank, step_q2.tpl_step[StepW-1:0]};
    tpl_addr_q2 <= tpl_addr_q;
    tpl_addr_q3 <= tpl_addr_q2;
    tpl_addr_q4 <= tpl_addr_q3;
  end

  slog_search_ring #(.GroupBits(GroupBits), .RingRows(RingRows), .WordsPerRow(WordsPerRow)) u_search (
      .clk_i,
      .rst_i,
      .wr_even_i (wr_even_q),
      .wr_odd_i  (wr_odd_q),
      .wr_pair_i (wr_pair_q),
      .wr_word_i (wr_word_q),
      .wr_data_i (wr_data_q),
      .wide_i    (step_q2.wide),
      .row_i     (step_q2.ring_row[RingW-1:0]),
      .chunk_i   (step_q2.chunk),
      .blank_a_i (blank_a_q[4]),
      .blank_b_i (blank_b_q[4]),
      .a_o       (search_a_o),
      .b_o       (search_b_o)
  );

  logic                 wr_tpl_a_q, wr_tpl_b_q;
  logic [StepW:0]       wr_addr_q2;
  logic [GroupBits-1:0] wr_data_q2, tpl_a, tpl_b;
  always_ff @(posedge clk_i) begin
    wr_tpl_a_q <= wr_tpl_q && !wr_high_q;
    wr_tpl_b_q <= wr_tpl_q && wr_high_q;
    wr_addr_q2 <= wr_addr_q;
    if (wr_tpl_q) wr_data_q2 <= wr_data_q;
  end

  // Always read: an enable would be a long net.
  slog_ram #(.Width(GroupBits), .Depth(2 ** (StepW + 1))) u_tpl_a (
      .clk_i, .wr_en_i(wr_tpl_a_q), .wr_addr_i(wr_addr_q2), .wr_data_i(wr_data_q2),
      .rd_en_i(1'b1), .rd_addr_i(tpl_addr_q4), .rd_data_o(tpl_a)
  );
  slog_ram #(.Width(GroupBits), .Depth(2 ** (StepW + 1))) u_tpl_b (
      .clk_i, .wr_en_i(wr_tpl_b_q), .wr_addr_i(wr_addr_q2), .wr_data_i(wr_data_q2),
      .rd_en_i(1'b1), .rd_addr_i(tpl_addr_q4), .rd_data_o(tpl_b)
  );
  logic tpl_blank_a_q, tpl_blank_b_q;
  always_ff @(posedge clk_i) begin
    tpl_blank_a_q <= blank_a_q[4];
    tpl_blank_b_q <= blank_b_q[4];
    // A separate if, so that synthesis uses the registers' reset inputs, which have their own network.
    if (rst_i) begin
      tpl_blank_a_q <= 1'b1;
      tpl_blank_b_q <= 1'b1;
    end
    tpl_a_o       <= tpl_blank_a_q ? '0 : tpl_a;
    tpl_b_o       <= tpl_blank_b_q ? '0 : tpl_b;
  end

  logic [HoldW-1:0] hold_q;
  logic             move_q;
  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      hold_q <= HoldW'(HoldClocks);
      move_q <= 1'b1;
    end else begin
      move_q <= control_q6.valid || hold_q != '0 || !HoldIdle;
      if (control_q6.valid) hold_q <= HoldW'(HoldClocks);
      else if (hold_q != '0) hold_q <= hold_q - 1'b1;
    end
  end

  assign move_o  = move_q;
  assign valid_o = control_q7.valid;
  assign first_o = control_q7.first;
  assign last_o  = control_q7.last;
  assign row_b_o = control_q7.row_b;
  assign lanes_o = control_q7.lanes;

`ifndef SYNTHESIS
  // The template word that is written in this clock is still needed by a step that has not read it yet.
  logic tpl_a_taken, tpl_b_taken;
  always_comb begin
    tpl_a_taken = (control_q.valid && tpl_addr_q == wr_addr_q2) || (control_q2.valid && tpl_addr_q2 == wr_addr_q2)
                  || (control_q3.valid && tpl_addr_q3 == wr_addr_q2) || (control_q4.valid && tpl_addr_q4 == wr_addr_q2);
    tpl_b_taken = (control_q.valid && control_q.row_b && tpl_addr_q == wr_addr_q2)
                  || (control_q2.valid && control_q2.row_b && tpl_addr_q2 == wr_addr_q2)
                  || (control_q3.valid && control_q3.row_b && tpl_addr_q3 == wr_addr_q2)
                  || (control_q4.valid && control_q4.row_b && tpl_addr_q4 == wr_addr_q2);
  end
  int unsigned clocks_since_valid;
  always_ff @(posedge clk_i) begin
    if (rst_i) clocks_since_valid <= HoldClocks;
    else clocks_since_valid <= valid_o ? 0 : clocks_since_valid + 32'(clocks_since_valid < HoldClocks);
  end
`endif
  `SLOG_ASSERT(SlogOperandsMove, move_o || (!valid_o && clocks_since_valid >= HoldClocks))
  `SLOG_ASSERT(SlogOperandsStep, !step_i.valid || (step_i.lanes != '0 && 32'(step_i.lanes) <= Lanes
                                 && 32'(step_i.ring_row) < RingRows && 32'(step_i.tpl_step) < 2 * GroupBits))
  `SLOG_ASSERT(SlogOperandsWrite, !wr_valid_i || 32'(wr_row_i) < (wr_tpl_i ? 2 * GroupBits : RingRows))
  `SLOG_ASSERT(SlogOperandsTplReuse, !(wr_tpl_a_q && tpl_a_taken) && !(wr_tpl_b_q && tpl_b_taken))
  `SLOG_PAST(past_rst, rst_i)
  `SLOG_ASSERT(SlogOperandsZeroA, valid_o || past_rst || (tpl_a_o == '0 && search_a_o == '0))
  `SLOG_ASSERT(SlogOperandsZeroB, (valid_o && row_b_o) || past_rst || (tpl_b_o == '0 && search_b_o == '0))
endmodule : slog_operands
