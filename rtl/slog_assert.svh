// Assertion macros: active in simulation, empty in synthesis. They sample at clk_i and, but for _NO_RESET, are off in rst_i.
`ifndef SLOG_ASSERT_SVH
`define SLOG_ASSERT_SVH

`ifdef SYNTHESIS
  `define SLOG_ASSERT(Name, Property)
  `define SLOG_ASSERT_NO_RESET(Name, Property)
  `define SLOG_ASSERT_STABLE(Name, Valid, Ready, Data)
  `define SLOG_ASSERT_INIT(Name, Condition)
`else
  // Property holds on every clock.
  `define SLOG_ASSERT(Name, Property) \
    Name : assert property (@(posedge clk_i) disable iff (rst_i) (Property)) \
      else $error("%m: %s", `"Name`");
  // The same in a module without reset: from 200 ns (20 clocks) after power-up on. Before that, the registers that drive
  // it may hold anything.
  `define SLOG_ASSERT_NO_RESET(Name, Property) \
    Name : assert property (@(posedge clk_i) disable iff ($time < 200) (Property)) \
      else $error("%m: %s", `"Name`");
  // Once offered, a transfer stays offered unchanged until it is taken.
  `define SLOG_ASSERT_STABLE(Name, Valid, Ready, Data) \
    Name : assert property (@(posedge clk_i) disable iff (rst_i) \
      ((Valid) && !(Ready)) |=> ((Valid) && $stable(Data))) else $error("%m: %s", `"Name`");
  // Elaboration check on parameters.
  `define SLOG_ASSERT_INIT(Name, Condition) \
    if (!(Condition)) begin : g_bad_``Name \
      $fatal(1, "%m: %s", `"Name`"); \
    end
`endif

`endif
