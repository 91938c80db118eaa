// SPDX-License-Identifier: Apache-2.0
// Simulation models of the ECP5 primitives that rtl/ecp5 uses, in the modes it uses and no others.
// Written from Lattice's descriptions (FPGA-TN-02204 memory, FPGA-TN-02205 sysDSP); the pairing of the data pins at 36 bits is
// that of Yosys' own block RAM map. Synthesis takes the port lists only: black boxes.

module DP16KD #(
    parameter int unsigned DATA_WIDTH_A = 18,
    parameter int unsigned DATA_WIDTH_B = 18,
    parameter REGMODE_A = "NOREG",
    parameter REGMODE_B = "NOREG",
    parameter RESETMODE = "SYNC",
    parameter ASYNC_RESET_RELEASE = "SYNC",
    parameter CSDECODE_A = "0b000",
    parameter CSDECODE_B = "0b000",
    parameter WRITEMODE_A = "NORMAL",
    parameter WRITEMODE_B = "NORMAL",
    parameter GSR = "ENABLED"
) (
    input logic CLKA, CEA, WEA, OCEA, RSTA, CSA0, CSA1, CSA2,
    input logic CLKB, CEB, WEB, OCEB, RSTB, CSB0, CSB1, CSB2,
    input logic ADA0, ADA1, ADA2, ADA3, ADA4, ADA5, ADA6, ADA7, ADA8, ADA9, ADA10, ADA11, ADA12, ADA13,
    input logic ADB0, ADB1, ADB2, ADB3, ADB4, ADB5, ADB6, ADB7, ADB8, ADB9, ADB10, ADB11, ADB12, ADB13,
        input logic DIA0, DIA1, DIA2, DIA3, DIA4, DIA5, DIA6, DIA7, DIA8, DIA9, DIA10, DIA11, DIA12, DIA13, DIA14,
        DIA15, DIA16, DIA17,
        input logic DIB0, DIB1, DIB2, DIB3, DIB4, DIB5, DIB6, DIB7, DIB8, DIB9, DIB10, DIB11, DIB12, DIB13, DIB14,
        DIB15, DIB16, DIB17,
        output logic DOA0, DOA1, DOA2, DOA3, DOA4, DOA5, DOA6, DOA7, DOA8, DOA9, DOA10, DOA11, DOA12, DOA13, DOA14,
        DOA15, DOA16, DOA17,
        output logic DOB0, DOB1, DOB2, DOB3, DOB4, DOB5, DOB6, DOB7, DOB8, DOB9, DOB10, DOB11, DOB12, DOB13, DOB14,
        DOB15, DOB16, DOB17
);
`ifndef SYNTHESIS
  localparam int unsigned Width = DATA_WIDTH_A;
  localparam int unsigned Shift = (Width == 36) ? 5 : (Width == 18) ? 4 : (Width == 9) ? 3 : (Width == 4) ? 2 :
                                  (Width == 2) ? 1 : 0;
  logic [Width-1:0] mem_q[2**(14-Shift)];
  logic [Width-1:0] latch_q, out_q;
  logic [13:0] wr_pins, rd_pins;
  logic [35:0] in;
  logic [3:0] bytes;

  assign wr_pins = {ADA13, ADA12, ADA11, ADA10, ADA9, ADA8, ADA7, ADA6, ADA5, ADA4, ADA3, ADA2, ADA1, ADA0};
  assign rd_pins = {ADB13, ADB12, ADB11, ADB10, ADB9, ADB8, ADB7, ADB6, ADB5, ADB4, ADB3, ADB2, ADB1, ADB0};
    assign in = {DIB17, DIB16, DIB15, DIB14, DIB13, DIB12, DIB11, DIB10, DIB9, DIB8, DIB7, DIB6, DIB5, DIB4, DIB3,
        DIB2, DIB1, DIB0,
                              DIA17, DIA16, DIA15, DIA14, DIA13, DIA12, DIA11, DIA10, DIA9, DIA8, DIA7, DIA6, DIA5,
        DIA4, DIA3, DIA2, DIA1, DIA0};
  assign bytes = (Width == 36) ? wr_pins[3:0] : (Width == 18) ? {2'b0, wr_pins[1:0]} : 4'b1;

  always_ff @(posedge CLKA) begin
    if (CEA && WEA && {CSA2, CSA1, CSA0} == 3'b0) begin
      for (int unsigned k = 0; k < Width; k++)
        if (bytes[2'(k / 9)]) mem_q[wr_pins[13:Shift]][k] <= in[k];
    end
  end
  always_ff @(posedge CLKB) begin
    if (CEB && !WEB && {CSB2, CSB1, CSB0} == 3'b0) latch_q <= mem_q[rd_pins[13:Shift]];
    if (RSTB) out_q <= '0;
    else if (OCEB) out_q <= latch_q;
  end
  // Paired ports at 36 bits; else everything leaves through B.
  logic [35:0] out;
  assign out = (Width == 36) ? 36'(out_q) : {18'(out_q), 18'b0};
    assign {DOB17, DOB16, DOB15, DOB14, DOB13, DOB12, DOB11, DOB10, DOB9, DOB8, DOB7, DOB6, DOB5, DOB4, DOB3, DOB2,
        DOB1, DOB0,
                    DOA17, DOA16, DOA15, DOA14, DOA13, DOA12, DOA11, DOA10, DOA9, DOA8, DOA7, DOA6, DOA5, DOA4,
        DOA3, DOA2, DOA1, DOA0} = out;

  if (DATA_WIDTH_A != DATA_WIDTH_B || REGMODE_A != "OUTREG" || REGMODE_B != "OUTREG") begin : g_bad_mode
    $fatal(1, "%m: mode not modelled");
  end
  if (!(Width inside {1, 2, 4, 9, 18, 36})) begin : g_bad_width
    $fatal(1, "%m: no such width");
  end
  if (Width == 36) begin : g_pair
    always_ff @(posedge CLKA) assert (OCEA == OCEB && RSTA == RSTB);
  end
`endif
endmodule : DP16KD

module MULT18X18D #(
    parameter REG_INPUTA_CLK = "NONE",
    parameter REG_INPUTA_CE = "CE0",
    parameter REG_INPUTA_RST = "RST0",
    parameter REG_INPUTB_CLK = "NONE",
    parameter REG_INPUTB_CE = "CE0",
    parameter REG_INPUTB_RST = "RST0",
    parameter REG_PIPELINE_CLK = "NONE",
    parameter REG_PIPELINE_CE = "CE0",
    parameter REG_PIPELINE_RST = "RST0",
    parameter REG_OUTPUT_CLK = "NONE",
    parameter REG_OUTPUT_CE = "CE0",
    parameter REG_OUTPUT_RST = "RST0",
    parameter GSR = "ENABLED",
    parameter RESETMODE = "SYNC"
) (
    input logic CLK0, CLK1, CLK2, CLK3, CE0, CE1, CE2, CE3, RST0, RST1, RST2, RST3,
    input logic SIGNEDA, SIGNEDB, SOURCEA, SOURCEB,
    input logic A0, A1, A2, A3, A4, A5, A6, A7, A8, A9, A10, A11, A12, A13, A14, A15, A16, A17,
    input logic B0, B1, B2, B3, B4, B5, B6, B7, B8, B9, B10, B11, B12, B13, B14, B15, B16, B17,
        output logic P0, P1, P2, P3, P4, P5, P6, P7, P8, P9, P10, P11, P12, P13, P14, P15, P16, P17, P18, P19, P20,
        P21, P22, P23, P24, P25, P26, P27, P28, P29, P30, P31, P32, P33, P34, P35
);
`ifndef SYNTHESIS
  logic [17:0] a, b, a_q, b_q;
  logic [35:0] p_q, p_q2;
  logic [3:0] ce;

  assign ce = {CE3, CE2, CE1, CE0};
  assign a  = {A17, A16, A15, A14, A13, A12, A11, A10, A9, A8, A7, A6, A5, A4, A3, A2, A1, A0};
  assign b  = {B17, B16, B15, B14, B13, B12, B11, B10, B9, B8, B7, B6, B5, B4, B3, B2, B1, B0};
    assign {P35, P34, P33, P32, P31, P30, P29, P28, P27, P26, P25, P24, P23, P22, P21, P20, P19, P18, P17, P16, P15,
        P14, P13, P12, P11, P10, P9, P8, P7, P6, P5, P4, P3, P2, P1, P0} = p_q2;

  // "CEn" -> n.
  function automatic logic enable(logic [23:0] name, logic [3:0] enables);
    return enables[name[1:0]];
  endfunction

  always_ff @(posedge CLK0) begin
    if (enable(REG_INPUTA_CE, ce)) a_q <= a;
    if (enable(REG_INPUTB_CE, ce)) b_q <= b;
    if (enable(REG_PIPELINE_CE, ce))
      p_q <= 36'($signed({SIGNEDA & a_q[17], a_q}) * $signed({SIGNEDB & b_q[17], b_q}));
    if (enable(REG_OUTPUT_CE, ce)) p_q2 <= p_q;
    assert (!RST0 && !SOURCEA && !SOURCEB);
  end
  if (REG_INPUTA_CLK != "CLK0" || REG_INPUTB_CLK != "CLK0" || REG_PIPELINE_CLK != "CLK0" ||
      REG_OUTPUT_CLK != "CLK0") begin : g_bad_mode
    $fatal(1, "%m: mode not modelled");
  end
`endif
endmodule : MULT18X18D

// Global clock network, always on.
module DCCA (
    input  logic CLKI,
    input  logic CE,
    output logic CLKO
);
  assign CLKO = CLKI && CE;
endmodule : DCCA
