// SPDX-License-Identifier: Apache-2.0
// Simulation models of the ECP5 cells that Yosys maps logic to (`synth_ecp5`), for netlists only; those that the RTL itself
// instantiates are in cells.sv. Written from Lattice's descriptions (FPGA-TN-02033 architecture, FPGA-TN-02204 memory).
// No register has a value at power-up: X where the simulator knows X, random in Verilator. That is harder than the chip,
// whose registers start reset: a module must come right from its reset alone.
// A multiplexer's output is known where both choices agree, as a look-up table's is, and X otherwise: a register whose
// reset or enable is X becomes X, and so does a memory whose write enable or address is. Icarus and Verilator both read this.

module LUT4 #(
    parameter logic [15:0] INIT = 16'h0
) (
    input  logic A, B, C, D,
    output logic Z
);
  logic [7:0] d;
  logic [3:0] c;
  logic [1:0] b;
  assign d = D ? INIT[15:8] : INIT[7:0];
  assign c = C ? d[7:4] : d[3:0];
  assign b = B ? c[3:2] : c[1:0];
  assign Z = A ? b[1] : b[0];
endmodule : LUT4

module PFUMX (
    input  logic ALUT, BLUT, C0,
    output logic Z
);
  assign Z = C0 ? ALUT : BLUT;
endmodule : PFUMX

module L6MUX21 (
    input  logic D0, D1, SD,
    output logic Z
);
  assign Z = SD ? D1 : D0;
endmodule : L6MUX21

module CCU2C #(
    parameter logic [15:0] INIT0 = 16'h0,
    parameter logic [15:0] INIT1 = 16'h0,
    parameter INJECT1_0 = "YES",
    parameter INJECT1_1 = "YES"
) (
    input  logic CIN, A0, B0, C0, D0, A1, B1, C1, D1,
    output logic S0, S1, COUT
);
  logic whole0, low0, whole1, low1, carry;

  LUT4 #(.INIT(INIT0)) u_whole0 (.A(A0), .B(B0), .C(C0), .D(D0), .Z(whole0));
  LUT4 #(.INIT({12'h0, INIT0[3:0]})) u_low0 (.A(A0), .B(B0), .C(1'b0), .D(1'b0), .Z(low0));
  LUT4 #(.INIT(INIT1)) u_whole1 (.A(A1), .B(B1), .C(C1), .D(D1), .Z(whole1));
  LUT4 #(.INIT({12'h0, INIT1[3:0]})) u_low1 (.A(A1), .B(B1), .C(1'b0), .D(1'b0), .Z(low1));
  assign S0    = whole0 ^ ((INJECT1_0 == "YES") ? 1'b0 : CIN);
  assign carry = whole0 ? CIN : (low0 && INJECT1_0 != "YES");
  assign S1    = whole1 ^ ((INJECT1_1 == "YES") ? 1'b0 : carry);
  assign COUT  = whole1 ? carry : (low1 && INJECT1_1 != "YES");
endmodule : CCU2C

module TRELLIS_FF #(
    parameter GSR = "ENABLED",
    parameter CEMUX = "1",
    parameter CLKMUX = "CLK",
    parameter LSRMUX = "LSR",
    parameter LSRONMUX = "LSRMUX",
    parameter SRMODE = "LSR_OVER_CE",
    parameter REGSET = "RESET",
    parameter LSRMODE = "LSR",
    parameter SD = "1"      // "0": the data come through M, as nextpnr lets them that do not come from the slice's own table
) (
    input  logic CLK, LSR, CE, DI, M,
    output logic Q
);
  logic data, enable, set;
  assign data   = (SD == "0") ? M : DI;
  assign enable = (CEMUX == "1") ? 1'b1 : (CEMUX == "0") ? 1'b0 : (CEMUX == "INV") ? !CE : CE;
  assign set    = (LSRMUX == "0") ? 1'b0 : (LSRMUX == "INV") ? !LSR : LSR;

  if (SRMODE == "ASYNC" || CLKMUX != "CLK" || LSRMODE != "LSR") begin : g_bad_mode
`ifndef YOSYS
    initial $fatal(1, "%m: mode not modelled");
`endif
  end
  if (SRMODE == "LSR_OVER_CE") begin : g_over
    always_ff @(posedge CLK) Q <= set ? (REGSET == "SET") : enable ? data : Q;
  end else begin : g_under
    always_ff @(posedge CLK) Q <= enable ? (set ? (REGSET == "SET") : data) : Q;
  end
endmodule : TRELLIS_FF

module TRELLIS_DPR16X4 #(
    parameter WCKMUX = "WCK",
    parameter WREMUX = "WRE",
    parameter logic [63:0] INITVAL = 64'h0
) (
    input  logic [3:0] DI, WAD, RAD,
    input  logic       WRE, WCK,
    output logic [3:0] DO
);
  logic [3:0] mem_q[16];
  always_ff @(posedge WCK) begin
    if (WRE) mem_q[WAD] <= DI;
`ifdef __ICARUS__
    if (WRE !== 1'b0 && ^{WRE, WAD} === 1'bx) for (int k = 0; k < 16; k++) mem_q[k] <= 'x;
`endif
  end
  assign DO = mem_q[RAD];
  if (WCKMUX != "WCK" || WREMUX != "WRE") begin : g_bad_mode
`ifndef YOSYS
    initial $fatal(1, "%m: mode not modelled");
`endif
  end
endmodule : TRELLIS_DPR16X4
