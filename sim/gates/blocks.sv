// SPDX-License-Identifier: Apache-2.0
// The block RAM and the multiplier of ../synth/cells.sv again, for Icarus, which does not read that file, and stricter about
// unknown values: a write whose enable or address is X makes all words X; a read whose enable is X gives X. The modes are
// those that rtl/ecp5 uses: 36, 18 or 9 bits with output registers; multiplier with all its registers.

module DP16KD #(
    parameter DATA_WIDTH_A = 18,
    parameter DATA_WIDTH_B = 18,
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
    input CLKA, CEA, WEA, OCEA, RSTA, CSA0, CSA1, CSA2,
    input CLKB, CEB, WEB, OCEB, RSTB, CSB0, CSB1, CSB2,
    input ADA0, ADA1, ADA2, ADA3, ADA4, ADA5, ADA6, ADA7, ADA8, ADA9, ADA10, ADA11, ADA12, ADA13,
    input ADB0, ADB1, ADB2, ADB3, ADB4, ADB5, ADB6, ADB7, ADB8, ADB9, ADB10, ADB11, ADB12, ADB13,
    input DIA0, DIA1, DIA2, DIA3, DIA4, DIA5, DIA6, DIA7, DIA8, DIA9, DIA10, DIA11, DIA12, DIA13, DIA14, DIA15, DIA16, DIA17,
    input DIB0, DIB1, DIB2, DIB3, DIB4, DIB5, DIB6, DIB7, DIB8, DIB9, DIB10, DIB11, DIB12, DIB13, DIB14, DIB15, DIB16, DIB17,
    output DOA0, DOA1, DOA2, DOA3, DOA4, DOA5, DOA6, DOA7, DOA8, DOA9, DOA10, DOA11, DOA12, DOA13, DOA14, DOA15, DOA16,
    output DOA17,
    output DOB0, DOB1, DOB2, DOB3, DOB4, DOB5, DOB6, DOB7, DOB8, DOB9, DOB10, DOB11, DOB12, DOB13, DOB14, DOB15, DOB16,
    output DOB17
);
  localparam WORDS = (DATA_WIDTH_A == 36) ? 512 : (DATA_WIDTH_A == 18) ? 1024 : 2048;
  wire [13:0] wr_pins, rd_pins;
  wire [10:0] wr_addr, rd_addr;
  wire [3:0] bytes;
  wire [35:0] in, out;
  reg [35:0] mem[0:WORDS-1];
  reg [35:0] latch, held;
  integer n;

  assign wr_pins = {ADA13, ADA12, ADA11, ADA10, ADA9, ADA8, ADA7, ADA6, ADA5, ADA4, ADA3, ADA2, ADA1, ADA0};
  assign rd_pins = {ADB13, ADB12, ADB11, ADB10, ADB9, ADB8, ADB7, ADB6, ADB5, ADB4, ADB3, ADB2, ADB1, ADB0};
  assign wr_addr = (DATA_WIDTH_A == 36) ? wr_pins[13:5] : (DATA_WIDTH_A == 18) ? wr_pins[13:4] : wr_pins[13:3];
  assign rd_addr = (DATA_WIDTH_A == 36) ? rd_pins[13:5] : (DATA_WIDTH_A == 18) ? rd_pins[13:4] : rd_pins[13:3];
  assign bytes   = (DATA_WIDTH_A == 36) ? wr_pins[3:0] : (DATA_WIDTH_A == 18) ? {2'b0, wr_pins[1:0]} : 4'b1;
  assign in = {DIB17, DIB16, DIB15, DIB14, DIB13, DIB12, DIB11, DIB10, DIB9, DIB8, DIB7, DIB6, DIB5, DIB4, DIB3, DIB2, DIB1,
               DIB0, DIA17, DIA16, DIA15, DIA14, DIA13, DIA12, DIA11, DIA10, DIA9, DIA8, DIA7, DIA6, DIA5, DIA4, DIA3, DIA2,
               DIA1, DIA0};
  assign out = (DATA_WIDTH_A == 36) ? held : {held[17:0], 18'b0};
  assign {DOB17, DOB16, DOB15, DOB14, DOB13, DOB12, DOB11, DOB10, DOB9, DOB8, DOB7, DOB6, DOB5, DOB4, DOB3, DOB2, DOB1, DOB0,
          DOA17, DOA16, DOA15, DOA14, DOA13, DOA12, DOA11, DOA10, DOA9, DOA8, DOA7, DOA6, DOA5, DOA4, DOA3, DOA2, DOA1,
          DOA0} = out;

  wire write = CEA && WEA && {CSA2, CSA1, CSA0} == 3'b0;
  wire read  = CEB && !WEB && {CSB2, CSB1, CSB0} == 3'b0;
  always @(posedge CLKA) begin
    if (write !== 1'b0) begin
      if (^{write, wr_addr, bytes} === 1'bx) for (n = 0; n < WORDS; n = n + 1) mem[n] <= 36'bx;
      else for (n = 0; n < 4; n = n + 1) if (bytes[n]) mem[wr_addr][9*n+:9] <= in[9*n+:9];
    end
  end
  always @(posedge CLKB) begin
    latch <= read ? mem[rd_addr] : latch;
    held  <= RSTB ? 36'b0 : OCEB ? latch : held;
  end

  initial begin
    if (!(DATA_WIDTH_A == 36 || DATA_WIDTH_A == 18 || DATA_WIDTH_A == 9) || DATA_WIDTH_B != DATA_WIDTH_A
        || REGMODE_A != "OUTREG" || REGMODE_B != "OUTREG") $fatal(1, "%m: mode not modelled");
  end
endmodule

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
    input CLK0, CLK1, CLK2, CLK3, CE0, CE1, CE2, CE3, RST0, RST1, RST2, RST3,
    input SIGNEDA, SIGNEDB, SOURCEA, SOURCEB,
    input A0, A1, A2, A3, A4, A5, A6, A7, A8, A9, A10, A11, A12, A13, A14, A15, A16, A17,
    input B0, B1, B2, B3, B4, B5, B6, B7, B8, B9, B10, B11, B12, B13, B14, B15, B16, B17,
    output P0, P1, P2, P3, P4, P5, P6, P7, P8, P9, P10, P11, P12, P13, P14, P15, P16, P17, P18, P19, P20, P21, P22, P23, P24,
    output P25, P26, P27, P28, P29, P30, P31, P32, P33, P34, P35
);
  reg signed [17:0] a, b;
  reg signed [35:0] product, out;

  assign {P35, P34, P33, P32, P31, P30, P29, P28, P27, P26, P25, P24, P23, P22, P21, P20, P19, P18, P17, P16, P15, P14, P13,
          P12, P11, P10, P9, P8, P7, P6, P5, P4, P3, P2, P1, P0} = out;
  always @(posedge CLK0) begin
    a       <= CE0 ? {A17, A16, A15, A14, A13, A12, A11, A10, A9, A8, A7, A6, A5, A4, A3, A2, A1, A0} : a;
    b       <= CE0 ? {B17, B16, B15, B14, B13, B12, B11, B10, B9, B8, B7, B6, B5, B4, B3, B2, B1, B0} : b;
    product <= CE0 ? a * b : product;
    out     <= CE0 ? product : out;
    if ({RST0, SOURCEA, SOURCEB, SIGNEDA, SIGNEDB} !== 5'b00011) $fatal(1, "%m: mode not modelled");
  end

  initial begin
    if (REG_INPUTA_CLK != "CLK0" || REG_INPUTB_CLK != "CLK0" || REG_PIPELINE_CLK != "CLK0" || REG_OUTPUT_CLK != "CLK0"
        || REG_INPUTA_CE != "CE0" || REG_INPUTB_CE != "CE0" || REG_PIPELINE_CE != "CE0" || REG_OUTPUT_CE != "CE0")
      $fatal(1, "%m: mode not modelled");
  end
endmodule

module DCCA (
    input  CLKI,
    input  CE,
    output CLKO
);
  assign CLKO = CLKI && CE;
endmodule
