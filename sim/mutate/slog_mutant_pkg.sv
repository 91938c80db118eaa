// SPDX-License-Identifier: Apache-2.0
// The number of the mutant that a simulation runs, from the argument +mutant=N; 0 without it: the module as it is.
package slog_mutant_pkg;
  function automatic int unsigned chosen();
    int unsigned number;
    if ($value$plusargs("mutant=%d", number) == 0) number = 0;
    return number;
  endfunction

  int unsigned id = chosen();
endpackage : slog_mutant_pkg
