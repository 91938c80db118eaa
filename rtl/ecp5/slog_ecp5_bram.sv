// SPDX-License-Identifier: Apache-2.0
// One ECP5 block RAM: one write port, one read port of the same width, output register in use.
//
// Latency    : rd_data_o holds the word two clocks after rd_en_i, or 0 where clear_i is high in the clock after it.
// Formats    : words of Bits = 1, 2, 4, 9, 18 or 36; 16384 / 8192 / 4096 / 2048 / 1024 / 512 of them.
//              Addresses are left aligned in the block's 14 address pins.
// At 36 bits the block joins its two ports: for reads and for writes port A's data pins carry the low half, port B's the
// high half.
module slog_ecp5_bram #(
    parameter int unsigned Bits = 18
) (
    input  logic            clk_i,
    input  logic            wr_en_i,
    input  logic [    13:0] wr_addr_i,
    input  logic [Bits-1:0] wr_data_i,
    input  logic            rd_en_i,
    input  logic            clear_i,
    input  logic [    13:0] rd_addr_i,
    output logic [Bits-1:0] rd_data_o
);
  logic [35:0] wr_data, rd_data;
  logic [13:0] wr_addr;

  assign wr_data   = 36'(wr_data_i);
  // From 18 bits on the lowest address pins are byte enables.
  assign wr_addr   = (Bits == 36) ? wr_addr_i | 14'hF : (Bits == 18) ? wr_addr_i | 14'h3 : wr_addr_i;
  assign rd_data_o = (Bits == 36) ? Bits'(rd_data) : Bits'(rd_data[35:18]);

  DP16KD #(
      .DATA_WIDTH_A(Bits), .DATA_WIDTH_B(Bits),
      .REGMODE_A("OUTREG"), .REGMODE_B("OUTREG"), .RESETMODE("SYNC"), .ASYNC_RESET_RELEASE("SYNC"),
      .CSDECODE_A("0b000"), .CSDECODE_B("0b000"), .WRITEMODE_A("NORMAL"), .WRITEMODE_B("NORMAL"), .GSR("DISABLED")
  ) u_bram (
      .CLKA(clk_i), .CEA(wr_en_i), .WEA(1'b1), .OCEA(1'b1), .RSTA(Bits == 36 ? clear_i : 1'b0),
      .CSA0(1'b0), .CSA1(1'b0), .CSA2(1'b0),
      .CLKB(clk_i), .CEB(rd_en_i), .WEB(1'b0), .OCEB(1'b1), .RSTB(clear_i),
      .CSB0(1'b0), .CSB1(1'b0), .CSB2(1'b0),
      .ADA0(wr_addr[0]), .ADA1(wr_addr[1]), .ADA2(wr_addr[2]), .ADA3(wr_addr[3]), .ADA4(wr_addr[4]),
      .ADA5(wr_addr[5]), .ADA6(wr_addr[6]), .ADA7(wr_addr[7]), .ADA8(wr_addr[8]), .ADA9(wr_addr[9]),
      .ADA10(wr_addr[10]), .ADA11(wr_addr[11]), .ADA12(wr_addr[12]), .ADA13(wr_addr[13]),
      .ADB0(rd_addr_i[0]), .ADB1(rd_addr_i[1]), .ADB2(rd_addr_i[2]), .ADB3(rd_addr_i[3]), .ADB4(rd_addr_i[4]),
      .ADB5(rd_addr_i[5]), .ADB6(rd_addr_i[6]), .ADB7(rd_addr_i[7]), .ADB8(rd_addr_i[8]), .ADB9(rd_addr_i[9]),
      .ADB10(rd_addr_i[10]), .ADB11(rd_addr_i[11]), .ADB12(rd_addr_i[12]), .ADB13(rd_addr_i[13]),
      .DIA0(wr_data[0]), .DIA1(wr_data[1]), .DIA2(wr_data[2]), .DIA3(wr_data[3]), .DIA4(wr_data[4]),
      .DIA5(wr_data[5]), .DIA6(wr_data[6]), .DIA7(wr_data[7]), .DIA8(wr_data[8]), .DIA9(wr_data[9]),
      .DIA10(wr_data[10]), .DIA11(wr_data[11]), .DIA12(wr_data[12]), .DIA13(wr_data[13]), .DIA14(wr_data[14]),
      .DIA15(wr_data[15]), .DIA16(wr_data[16]), .DIA17(wr_data[17]),
      .DIB0(wr_data[18]), .DIB1(wr_data[19]), .DIB2(wr_data[20]), .DIB3(wr_data[21]), .DIB4(wr_data[22]),
      .DIB5(wr_data[23]), .DIB6(wr_data[24]), .DIB7(wr_data[25]), .DIB8(wr_data[26]), .DIB9(wr_data[27]),
      .DIB10(wr_data[28]), .DIB11(wr_data[29]), .DIB12(wr_data[30]), .DIB13(wr_data[31]), .DIB14(wr_data[32]),
      .DIB15(wr_data[33]), .DIB16(wr_data[34]), .DIB17(wr_data[35]),
      .DOA0(rd_data[0]), .DOA1(rd_data[1]), .DOA2(rd_data[2]), .DOA3(rd_data[3]), .DOA4(rd_data[4]),
      .DOA5(rd_data[5]), .DOA6(rd_data[6]), .DOA7(rd_data[7]), .DOA8(rd_data[8]), .DOA9(rd_data[9]),
      .DOA10(rd_data[10]), .DOA11(rd_data[11]), .DOA12(rd_data[12]), .DOA13(rd_data[13]), .DOA14(rd_data[14]),
      .DOA15(rd_data[15]), .DOA16(rd_data[16]), .DOA17(rd_data[17]),
      .DOB0(rd_data[18]), .DOB1(rd_data[19]), .DOB2(rd_data[20]), .DOB3(rd_data[21]), .DOB4(rd_data[22]),
      .DOB5(rd_data[23]), .DOB6(rd_data[24]), .DOB7(rd_data[25]), .DOB8(rd_data[26]), .DOB9(rd_data[27]),
      .DOB10(rd_data[28]), .DOB11(rd_data[29]), .DOB12(rd_data[30]), .DOB13(rd_data[31]), .DOB14(rd_data[32]),
      .DOB15(rd_data[33]), .DOB16(rd_data[34]), .DOB17(rd_data[35])
  );
endmodule : slog_ecp5_bram
