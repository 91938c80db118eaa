// SPDX-License-Identifier: Apache-2.0
// Simulation models of the cells that nextpnr packs a netlist of the ECP5 into and writes after routing, besides those of
// gates.sv and cells.sv. Written from Lattice's descriptions (FPGA-TN-02033 architecture, FPGA-TN-02204 memory) and from what
// nextpnr does with each pin. Open pins have their constants already: see sim/gates/routed.py.
// Icarus and Verilator both read this; unknown values spread as in gates.sv.

// Half of a slice: a look-up table with what follows it.
//   MODE  LOGIC  F is the table's bit.
//         CCU2   F is that bit and the carry summed, FCO the carry out: FCI where the table is 1, else what the table gives
//                for A and B with C and D low. CCU2_INJECT1 "YES" cuts the carry off: F is the table's bit, FCO 0 or FCI.
//         DPRAM  the table is a memory, read at {RAD3, RAD2, RAD1, RAD0} = {A, C, B, D} and written at WAD.
//   MUX   F1     OFX is F, or F1 of the slice's other half where M is high (the slice's first half).
//         FX     OFX is FXA, or FXB where M is high (its second half).
module TRELLIS_COMB #(
    parameter MODE = "LOGIC",
    parameter MUX = "F1",
    parameter [15:0] INITVAL = 16'h0,
    parameter CCU2_INJECT1 = "NO",
    parameter WREMUX = "WRE",
    parameter WCKMUX = "WCK"
) (
    input  logic A, B, C, D, M, F1, FCI, FXA, FXB, WD, WAD0, WAD1, WAD2, WAD3, WRE, WCK,
    output logic F, FCO, OFX
);
  if (MODE == "LOGIC") begin : g_logic
    LUT4 #(.INIT(INITVAL)) u_lut (.A(A), .B(B), .C(C), .D(D), .Z(F));
    assign FCO = 1'b0;
  end else if (MODE == "CCU2") begin : g_carry
    logic whole, low;
    LUT4 #(.INIT(INITVAL)) u_whole (.A(A), .B(B), .C(C), .D(D), .Z(whole));
    LUT4 #(.INIT({12'h0, INITVAL[3:0]})) u_low (.A(A), .B(B), .C(1'b0), .D(1'b0), .Z(low));
    if (CCU2_INJECT1 == "YES") begin : g_cut
      assign F   = whole;
      assign FCO = whole ? FCI : 1'b0;
    end else begin : g_sum
      assign F   = whole ^ FCI;
      assign FCO = whole ? FCI : low;
    end
  end else if (MODE == "DPRAM") begin : g_memory
    logic [15:0] mem_q;
    logic [3:0] wr_addr;
    assign wr_addr = {WAD3, WAD2, WAD1, WAD0};
    always_ff @(posedge WCK) begin
      if (WRE) mem_q[wr_addr] <= WD;
`ifdef __ICARUS__
      if (WRE !== 1'b0 && ^{WRE, wr_addr} === 1'bx) mem_q <= 16'bx;
`endif
    end
    assign F   = mem_q[{A, C, B, D}];
    assign FCO = 1'b0;
    if (WCKMUX != "WCK" || WREMUX != "WRE") begin : g_bad_mode
`ifndef YOSYS
      initial $fatal(1, "%m: mode not modelled");
`endif
    end
  end else begin : g_bad_mode
`ifndef YOSYS
    initial $fatal(1, "%m: mode not modelled");
`endif
  end
  if (MUX == "F1") begin : g_five
    assign OFX = M ? F1 : F;
  end else begin : g_six
    assign OFX = M ? FXB : FXA;
  end
endmodule : TRELLIS_COMB

// The half of a slice that takes the write address and data of a memory to the two slices that hold it.
module TRELLIS_RAMW (
    input  logic A0, B0, C0, D0, A1, B1, C1, D1,
    output logic WADO0, WADO1, WADO2, WADO3, WDO0, WDO1, WDO2, WDO3
);
  assign {WADO3, WADO2, WADO1, WADO0} = {A0, C0, B0, D0};
  assign {WDO3, WDO2, WDO1, WDO0}     = {B1, D1, A1, C1};
endmodule : TRELLIS_RAMW

// A pin: TRELLIS_IO of one direction each, as a simulator resolves a port of both directions slowly.
module TRELLIS_IO_INPUT (
    input  logic B,
    output logic O
);
  assign O = B;
endmodule : TRELLIS_IO_INPUT

module TRELLIS_IO_OUTPUT (
    input  logic I,
    output logic B
);
  assign B = I;
endmodule : TRELLIS_IO_OUTPUT
