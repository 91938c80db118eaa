// SPDX-License-Identifier: Apache-2.0
// Assertion macros: active in simulation and in proofs, empty in synthesis. They sample at clk_i and, but for _NO_RESET,
// are off in rst_i. Proofs (FORMAL) use immediate assertions, because open-source Yosys reads no others: a property is a
// plain condition; what held in the clock before is in a register that SLOG_PAST declares, or is the business of a macro.
`ifndef SLOG_ASSERT_SVH
`define SLOG_ASSERT_SVH

// Name is Value one clock later; only assertions use it.
`ifdef SYNTHESIS
  `define SLOG_PAST(Name, Value)
`else
  `define SLOG_PAST(Name, Value) \
    logic [$bits(Value)-1:0] Name; \
    always_ff @(posedge clk_i) Name <= (Value);
`endif

`ifdef SYNTHESIS
  `define SLOG_ASSERT(Name, Property)
  `define SLOG_ASSERT_NO_RESET(Name, Property)
  `define SLOG_ASSERT_NEXT(Name, Before, After)
  `define SLOG_ASSERT_KEPT(Name, Before, Data)
  `define SLOG_ASSERT_STABLE(Name, Valid, Ready, Data)
  `define SLOG_ASSERT_INIT(Name, Condition)
`elsif FORMAL
  `define SLOG_ASSERT(Name, Property) \
    always_ff @(posedge clk_i) if (!rst_i) Name : assert (Property);
  `define SLOG_ASSERT_NO_RESET(Name, Property) \
    logic [1:0] Name``_age = 2'd0; \
    always_ff @(posedge clk_i) begin \
      if (Name``_age != 2'd3) Name``_age <= Name``_age + 1'b1; \
      else Name : assert (Property); \
    end
  `define SLOG_ASSERT_NEXT(Name, Before, After) \
    logic Name``_before = 1'b0; \
    always_ff @(posedge clk_i) begin \
      Name``_before <= !rst_i && (Before); \
      if (!rst_i) Name : assert (!Name``_before || (After)); \
    end
  `define SLOG_ASSERT_KEPT(Name, Before, Data) \
    logic [$bits(Data)-1:0] Name``_data; \
    always_ff @(posedge clk_i) Name``_data <= (Data); \
    `SLOG_ASSERT_NEXT(Name, Before, (Data) == Name``_data)
  `define SLOG_ASSERT_STABLE(Name, Valid, Ready, Data) \
    logic [$bits(Data)-1:0] Name``_data; \
    always_ff @(posedge clk_i) Name``_data <= (Data); \
    `SLOG_ASSERT_NEXT(Name, (Valid) && !(Ready), (Valid) && (Data) == Name``_data)
  `define SLOG_ASSERT_INIT(Name, Condition) \
    if (!(Condition)) begin : g_bad_``Name \
      $fatal(1, `"Name`"); \
    end
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
  // After a clock in which Before holds, After holds.
  `define SLOG_ASSERT_NEXT(Name, Before, After) \
    Name : assert property (@(posedge clk_i) disable iff (rst_i) (Before) |=> (After)) \
      else $error("%m: %s", `"Name`");
  // After a clock in which Before holds, Data is as it was in that clock.
  `define SLOG_ASSERT_KEPT(Name, Before, Data) \
    Name : assert property (@(posedge clk_i) disable iff (rst_i) (Before) |=> $stable(Data)) \
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
