// SPDX-License-Identifier: Apache-2.0
// slog_operands as two plain memories: nine clocks after a step its operands are the words last written before it.
//
// One template word and one ring word are watched. They are not written from a step that uses them on for ReuseClocks.
module slog_rules_operands
  import slog_pkg::*, slog_array_pkg::*;
#(
    parameter int unsigned GroupBits   = 4,
    parameter int unsigned RingRows    = 4,
    parameter int unsigned WordsPerRow = 8,
    parameter int unsigned LaneW       = 2,
    parameter int unsigned StepW       = 3,
    parameter int unsigned RingW       = 2,
    parameter int unsigned HoldW       = 5
) (
    input logic                             clk_i,
    input logic                             rst_i,
    input logic                             wr_valid_i,
    input logic                             wr_tpl_i,
    input logic                             wr_wide_i,
    input logic                             wr_bank_i,
    input logic [7:0]                       wr_row_i,
    input logic [3:0]                       wr_word_i,
    input logic [GroupBits-1:0]             wr_data_i,
    input step_t                            step_i,
    input logic                             valid_o,
    input logic [HoldW-1:0]                 hold_q,
    input int unsigned                      clocks_since_valid,
    input logic                             first_o,
    input logic                             last_o,
    input logic                             row_b_o,
    input logic [LaneW-1:0]                 lanes_o,
    input logic [GroupBits-1:0]             tpl_a_o,
    input logic [GroupBits-1:0]             tpl_b_o,
    input logic [GroupBits+GroupBits/2-1:0] search_a_o,
    input logic [GroupBits+GroupBits/2-1:0] search_b_o
);
  localparam int unsigned Pitch = GroupBits / 2;
  localparam int unsigned Hold  = hold_clocks(GroupBits, GroupBits / 2 + 1);
  typedef struct packed {
    step_t                step;
    logic                 tpl_known;
    logic [GroupBits-1:0] tpl;
    logic                 ring_known;
    logic [GroupBits-1:0] ring;
  } seen_t;
  logic [StepW:0] tpl_place;      // {bank, address}
  logic tpl_high;                 // the memory of tpl_b
  logic [RingW-1:0] ring_row;
  logic [3:0] ring_word;
  slog_rules_choice #(.Width(StepW + RingW + 6)) u_choice (
      .clk_i, .choice({tpl_place, tpl_high, ring_row, ring_word}));
  logic tpl_known_q, ring_known_q, tpl_written, ring_written;
  logic [GroupBits-1:0] tpl_q, ring_q;
  seen_t [OperandLatency-1:0] seen_q;
  seen_t out;
  logic [StepW-1:0] wr_at;
  logic [2:0] a_hit, b_hit;       // [j]: unit j of the output is in the watched word
  logic [5:0] unit_a, unit_b;
  logic [RingW-1:0] row_b;
  logic [ReuseClocks-1:0] tpl_used, ring_used;  // [k]: by the step k clocks ago

  assign wr_at        = wr_wide_i ? wr_row_i[StepW-1:0] : StepW'(wr_row_i[StepW-1:1]);
  assign tpl_written  = wr_valid_i && wr_tpl_i && {wr_bank_i, wr_at} == tpl_place
                        && (wr_wide_i ? wr_word_i[0] : wr_row_i[0]) == tpl_high;
  assign ring_written = wr_valid_i && !wr_tpl_i && wr_row_i[RingW-1:0] == ring_row && wr_word_i == ring_word;

  function automatic logic uses_tpl(step_t step);
    return step.valid && {step.bank, step.tpl_step[StepW-1:0]} == tpl_place && (step.row_b || !tpl_high);
  endfunction
  // Any unit of either group.
  function automatic logic uses_ring(step_t step);
    int unsigned first = 32'(step.chunk);
    int unsigned low = 2 * 32'(ring_word);
    logic a = step.ring_row[RingW-1:0] == ring_row && first <= low + 1 && low <= first + (step.wide ? 4 : 2);
    logic b = !step.wide && step.row_b && RingW'(step.ring_row + 1'b1) == ring_row && first <= low + 1 && low <= first + 2;
    return step.valid && (a || b);
  endfunction

  // The half word of unit; a wide step's group B begins two units on, which is the same half.
  function automatic logic [Pitch-1:0] half(logic [GroupBits-1:0] word, logic [5:0] unit);
    return unit[0] ? word[GroupBits-1:Pitch] : word[Pitch-1:0];
  endfunction

  // Where the watched words are once their registers are behind them, which makes the proof inductive.
  logic [1:0] tpl_age_q, ring_age_q;                   // clocks since the word was written, up to 3
  logic [GroupBits-1:0] ring_mem[2][2][2], tpl_mem, ring_at;  // [row parity][quad parity][word parity]
  for (genvar r = 0; r < 2; r++) begin : g_row
    for (genvar q = 0; q < 2; q++) begin : g_quad
      for (genvar w = 0; w < 2; w++) begin : g_word
        assign ring_mem[r][q][w] = slog_operands.u_search.g_row[r].g_quad[q].g_word[w].u_ram.mem_q[
            {ring_word[3:2], ring_row[RingW-1:1]}];
      end
    end
  end
  assign tpl_mem = tpl_high ? slog_operands.u_tpl_b.mem_q[tpl_place] : slog_operands.u_tpl_a.mem_q[tpl_place];
  assign ring_at = ring_mem[ring_row[0]][ring_word[1]][ring_word[0]];
  always_ff @(posedge clk_i) begin
    tpl_age_q  <= tpl_written ? '0 : tpl_age_q + 2'(tpl_age_q != '1);
    ring_age_q <= ring_written ? '0 : ring_age_q + 2'(ring_age_q != '1);
    if (!rst_i) begin
      RulesOperandsTplKept : assert (!tpl_known_q || tpl_age_q != '1 || tpl_mem == tpl_q);
      RulesOperandsHold : assert (clocks_since_valid <= Hold && (valid_o || 32'(hold_q) + clocks_since_valid + 1 >= Hold));
      RulesOperandsRingKept : assert (!ring_known_q || ring_age_q != '1 || ring_at == ring_q);
    end
  end

  assign out = seen_q[OperandLatency-1];
  always_comb begin
    row_b = out.step.wide ? out.step.ring_row[RingW-1:0] : RingW'(out.step.ring_row + 1'b1);
    for (int unsigned j = 0; j < 3; j++) begin
      unit_a   = 6'(out.step.chunk) + 6'(j);
      unit_b   = unit_a + (out.step.wide ? 6'd2 : 6'd0);
      a_hit[j] = out.step.valid && out.ring_known && out.step.ring_row[RingW-1:0] == ring_row
                 && unit_a[5:1] == 5'(ring_word);
      b_hit[j] = out.step.valid && out.step.row_b && out.ring_known && row_b == ring_row && unit_b[5:1] == 5'(ring_word);
    end
    for (int unsigned k = 0; k < ReuseClocks; k++) begin
      tpl_used[k]  = uses_tpl((k == 0) ? step_i : seen_q[(k==0)?0 : k-1].step);
      ring_used[k] = uses_ring((k == 0) ? step_i : seen_q[(k==0)?0 : k-1].step);
    end
  end

  always_ff @(posedge clk_i) begin
    if (tpl_written) tpl_q <= wr_data_i;
    if (ring_written) ring_q <= wr_data_i;
    if (rst_i) begin
      tpl_known_q  <= 1'b0;
      ring_known_q <= 1'b0;
      seen_q       <= '0;
    end else begin
      tpl_known_q  <= tpl_known_q || tpl_written;
      ring_known_q <= ring_known_q || ring_written;
      seen_q       <= {seen_q[OperandLatency-2:0], seen_t'{step: step_i, tpl_known: tpl_known_q, tpl: tpl_q,
                       ring_known: ring_known_q, ring: ring_q}};
    end
    AssumePlace : assume (32'(ring_word) < WordsPerRow);
    if (!rst_i) begin
      AssumeWord : assume (!wr_valid_i || wr_tpl_i || 32'(wr_word_i) < WordsPerRow);
      AssumeWide : assume (!step_i.valid || !step_i.wide || step_i.row_b);
      AssumeReuse : assume (!(tpl_written && tpl_used != '0) && !(ring_written && ring_used != '0));
      RulesOperandsControl : assert (valid_o == out.step.valid && (!valid_o || {first_o, last_o, row_b_o, lanes_o}
                                     == {out.step.first, out.step.last, out.step.row_b, out.step.lanes[LaneW-1:0]}));
      RulesOperandsTemplate : assert (!(uses_tpl(out.step) && out.tpl_known) || (tpl_high ? tpl_b_o : tpl_a_o) == out.tpl);
      RulesOperandsSearchA : assert ((!a_hit[0] || search_a_o[Pitch-1:0] == half(out.ring, 6'(out.step.chunk)))
          && (!a_hit[1] || search_a_o[2*Pitch-1:Pitch] == half(out.ring, 6'(out.step.chunk) + 6'd1))
          && (!a_hit[2] || search_a_o[3*Pitch-1:2*Pitch] == half(out.ring, 6'(out.step.chunk) + 6'd2)));
      RulesOperandsSearchB : assert ((!b_hit[0] || search_b_o[Pitch-1:0] == half(out.ring, 6'(out.step.chunk)))
          && (!b_hit[1] || search_b_o[2*Pitch-1:Pitch] == half(out.ring, 6'(out.step.chunk) + 6'd1))
          && (!b_hit[2] || search_b_o[3*Pitch-1:2*Pitch] == half(out.ring, 6'(out.step.chunk) + 6'd2)));
      CoverTemplate : cover (uses_tpl(out.step) && out.tpl_known && tpl_high && out.tpl == '1);
      CoverNextRow : cover (b_hit[2] && !out.step.wide && out.step.ring_row[0] && ring_word[2]);
      CoverWide : cover (b_hit[2] && out.step.wide && out.step.chunk[0]);
      CoverRewritten : cover (tpl_written && tpl_known_q && out.tpl_known && uses_tpl(out.step) && out.tpl != tpl_q);
    end
  end
endmodule : slog_rules_operands

bind slog_operands slog_rules_operands #(.GroupBits(GroupBits), .RingRows(RingRows), .WordsPerRow(WordsPerRow),
                                         .LaneW(LaneW), .StepW(StepW), .RingW(RingW), .HoldW(HoldW)) u_rules (.*);
