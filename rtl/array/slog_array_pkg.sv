// SPDX-License-Identifier: Apache-2.0
// Timing of slog_operands and slog_array, as functions of their parameters. Mirrored in golden/cycle/array/timing.py.
//
// All counts are clocks from the clock in which slog_operands' step_i.valid is high.
package slog_array_pkg;
  // From step_i to the operand outputs.
  localparam int unsigned OperandLatency = 9;
  // From wr_valid_i of a word to the first step_i that may read it.
  localparam int unsigned WriteLatency = 1;
  // From step_i to the first wr_valid_i that may overwrite a word the step reads.
  localparam int unsigned ReuseClocks = 4;

  // Levels of the popcount tree: both operand groups together hold 2**(levels + 1) bits.
  function automatic int unsigned levels(int unsigned group_bits);
    return $clog2(group_bits);
  endfunction

  // Bits of a count of mismatches, 0..(2*group_bits)**2.
  function automatic int unsigned score_bits(int unsigned group_bits);
    return 2 * $clog2(group_bits) + 3;
  endfunction

  // From the last operands of a pass at slog_array's inputs to the pass's first mismatch_valid_o:
  // hop 1, XOR 1, tree levels, accumulator 1 + score_bits (bit 0 first), lane selection 3.
  function automatic int unsigned core_latency(int unsigned group_bits);
    return levels(group_bits) + score_bits(group_bits) + 6;
  endfunction

  // From the last step of a pass to its first mismatch_valid_o.
  function automatic int unsigned array_latency(int unsigned group_bits);
    return OperandLatency + core_latency(group_bits);
  endfunction

  // Clocks for which slog_array's move_i must stay high after a clock with valid operands.
  function automatic int unsigned hold_clocks(int unsigned group_bits, int unsigned lanes);
    return core_latency(group_bits) + lanes;
  endfunction

  // Clocks without a valid step that must pass before mask_i may change.
  function automatic int unsigned drain_clocks(int unsigned group_bits, int unsigned lanes);
    return OperandLatency + lanes + levels(group_bits);
  endfunction
endpackage : slog_array_pkg
