// SPDX-License-Identifier: Apache-2.0
// `slog_mult` on the ECP5's 18x18 multiplier with its input, pipeline and output registers in use.
//
// Latency, throughput, rules, formats: those of ../cells/slog_mult.sv. The registers have no clock enable: the four
// multipliers of a block share four enables, which would constrain placement too much. The coefficient passes through
// a register, because its source lies far away.
module slog_mult (
    input  logic               clk_i,
    /* verilator lint_off UNUSEDSIGNAL */
    input  logic               en_i,
    /* verilator lint_on UNUSEDSIGNAL */
    input  logic signed [17:0] a_i,
    input  logic signed [17:0] b_i,
    output logic signed [35:0] p_o
);
  logic [17:0] b_q;
  always_ff @(posedge clk_i) b_q <= b_i;

  MULT18X18D #(
      .REG_INPUTA_CLK("CLK0"), .REG_INPUTA_CE("CE0"), .REG_INPUTA_RST("RST0"),
      .REG_INPUTB_CLK("CLK0"), .REG_INPUTB_CE("CE0"), .REG_INPUTB_RST("RST0"),
      .REG_PIPELINE_CLK("CLK0"), .REG_PIPELINE_CE("CE0"), .REG_PIPELINE_RST("RST0"),
      .REG_OUTPUT_CLK("CLK0"), .REG_OUTPUT_CE("CE0"), .REG_OUTPUT_RST("RST0"),
      .GSR("DISABLED"), .RESETMODE("SYNC")
  ) u_mult (
      .CLK0(clk_i), .CLK1(1'b0), .CLK2(1'b0), .CLK3(1'b0),
      .CE0(1'b1), .CE1(1'b0), .CE2(1'b0), .CE3(1'b0),
      .RST0(1'b0), .RST1(1'b0), .RST2(1'b0), .RST3(1'b0),
      .SIGNEDA(1'b1), .SIGNEDB(1'b1), .SOURCEA(1'b0), .SOURCEB(1'b0),
      .A0(a_i[0]), .A1(a_i[1]), .A2(a_i[2]), .A3(a_i[3]), .A4(a_i[4]), .A5(a_i[5]),
      .A6(a_i[6]), .A7(a_i[7]), .A8(a_i[8]), .A9(a_i[9]), .A10(a_i[10]), .A11(a_i[11]),
      .A12(a_i[12]), .A13(a_i[13]), .A14(a_i[14]), .A15(a_i[15]), .A16(a_i[16]), .A17(a_i[17]),
      .B0(b_q[0]), .B1(b_q[1]), .B2(b_q[2]), .B3(b_q[3]), .B4(b_q[4]), .B5(b_q[5]),
      .B6(b_q[6]), .B7(b_q[7]), .B8(b_q[8]), .B9(b_q[9]), .B10(b_q[10]), .B11(b_q[11]),
      .B12(b_q[12]), .B13(b_q[13]), .B14(b_q[14]), .B15(b_q[15]), .B16(b_q[16]), .B17(b_q[17]),
      .P0(p_o[0]), .P1(p_o[1]), .P2(p_o[2]), .P3(p_o[3]), .P4(p_o[4]), .P5(p_o[5]),
      .P6(p_o[6]), .P7(p_o[7]), .P8(p_o[8]), .P9(p_o[9]), .P10(p_o[10]), .P11(p_o[11]),
      .P12(p_o[12]), .P13(p_o[13]), .P14(p_o[14]), .P15(p_o[15]), .P16(p_o[16]), .P17(p_o[17]),
      .P18(p_o[18]), .P19(p_o[19]), .P20(p_o[20]), .P21(p_o[21]), .P22(p_o[22]), .P23(p_o[23]),
      .P24(p_o[24]), .P25(p_o[25]), .P26(p_o[26]), .P27(p_o[27]), .P28(p_o[28]), .P29(p_o[29]),
      .P30(p_o[30]), .P31(p_o[31]), .P32(p_o[32]), .P33(p_o[33]), .P34(p_o[34]), .P35(p_o[35])
  );
endmodule : slog_mult
