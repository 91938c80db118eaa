// Comparison of unsigned numbers in two clocks: bytes first (register the partial result), then their verdict.
//
// Shorter numbers are zero-extended; what is constant costs nothing.
package slog_compare_pkg;
  typedef struct packed {
    logic [3:0] above;
    logic [3:0] equal;
  } partial_t;

  // Byte by byte: a above b, a equal to b.
  function automatic partial_t compare(logic [31:0] a, logic [31:0] b);
    partial_t p;
    for (int k = 0; k < 4; k++) begin
      p.above[k] = a[8*k+:8] > b[8*k+:8];
      p.equal[k] = a[8*k+:8] == b[8*k+:8];
    end
    return p;
  endfunction

  // a > b.
  function automatic logic is_above(partial_t p);
    return p.above[3] || (p.equal[3] && (p.above[2] || (p.equal[2] && (p.above[1] || (p.equal[1] && p.above[0])))));
  endfunction
endpackage : slog_compare_pkg
