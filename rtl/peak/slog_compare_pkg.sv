// Comparison of unsigned numbers by one carry chain.
//
// Shorter numbers are zero-extended; what is constant costs nothing.
package slog_compare_pkg;
  // a > b: b - a borrows. Said so because a plain > is built of look-up tables where those are fewer, which is slower.
  function automatic logic is_above(logic [31:0] a, logic [31:0] b);
    return 1'((33'(b) - 33'(a)) >> 32);
  endfunction
endpackage : slog_compare_pkg
