// SPDX-License-Identifier: Apache-2.0
// Comparison of unsigned numbers by one carry chain.
//
// Shorter numbers are zero-extended; constant bits cost no logic.
package slog_compare_pkg;
  // a > b: b - a borrows. A subtraction, so that synthesis uses a carry chain: for > it may use look-up tables, which
  // are fewer but slower.
  function automatic logic is_above(logic [31:0] a, logic [31:0] b);
    return 1'((33'(b) - 33'(a)) >> 32);
  endfunction
endpackage : slog_compare_pkg
