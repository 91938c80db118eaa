// SPDX-License-Identifier: Apache-2.0
// Runs a board's netlist from all-X: reset, one frame from each camera, jobs; for Icarus, without Python. It plays a program
// of register accesses and fails at the first value that is not the expected one, at the first unknown value on a handshake
// or flag after the reset, or if something does not come.
//
// program.hex: words of {operation[8], address[16], data[32], mask[32]}, made by sim/gates/icarus.py with the results of the
// golden model:
//   0 end; 1 write data; 2 read, and the bits of mask must be those of data; 3 read until they are;
//   4 camera `address` sends its frame, while the program goes on.
// frame0.hex, frame1.hex: pixels in raster order. surface.hex: the scores that must be streamed, {last, first, score[16]}.
// flags.svh: `flags`, every net of the netlist that is named as a handshake or flag, and their number `Flags`.
module tb_gates #(
    parameter Width = 48,
    parameter Height = 36,
    parameter Steps = 1,     // of the program
    parameter Beats = 1,     // of the surface
    parameter Reset = 1,     // clocks for which the pin is held
    parameter Settle = 7     // clocks after the reset's first until the board's own reset is over
);
  localparam Limit = 60000;

  reg clk = 1'b0;
  always #5 clk = !clk;

  reg [87:0] steps[0:Steps-1];
  reg [7:0] frame0[0:Width*Height-1];
  reg [7:0] frame1[0:Width*Height-1];
  reg [17:0] surface[0:Beats-1];
  initial begin
    $readmemh("program.hex", steps);
    $readmemh("frame0.hex", frame0);
    $readmemh("frame1.hex", frame1);
    $readmemh("surface.hex", surface);
  end

  reg rst;
  reg [7:0] awaddr, araddr;
  reg awvalid, wvalid, arvalid;
  reg [31:0] wdata;
  wire awready, wready, arready, bvalid, rvalid;
  wire [1:0] bresp, rresp;
  wire [31:0] rdata;
  reg [1:0] sending;
  integer at[0:1];
  wire [1:0] vid_ready;
  wire [15:0] vid_data = {frame1[sending[1] ? at[1] : 0], frame0[sending[0] ? at[0] : 0]};
  wire [1:0] vid_user = {at[1] == 0, at[0] == 0};
  wire [1:0] vid_last = {at[1] % Width == Width - 1, at[0] % Width == Width - 1};
  wire [15:0] surf_data;
  wire surf_valid, surf_user, surf_last, irq;

  slog_board u_dut (
      .clk_i(clk), .rst_i(rst),
      .s_axil_awaddr(awaddr), .s_axil_awprot(3'b0), .s_axil_awvalid(awvalid), .s_axil_awready(awready),
      .s_axil_wdata(wdata), .s_axil_wstrb(4'hF), .s_axil_wvalid(wvalid), .s_axil_wready(wready),
      .s_axil_bresp(bresp), .s_axil_bvalid(bvalid), .s_axil_bready(1'b1),
      .s_axil_araddr(araddr), .s_axil_arprot(3'b0), .s_axil_arvalid(arvalid), .s_axil_arready(arready),
      .s_axil_rdata(rdata), .s_axil_rresp(rresp), .s_axil_rvalid(rvalid), .s_axil_rready(1'b1),
      .vid_tdata_i(vid_data), .vid_tvalid_i(sending), .vid_tready_o(vid_ready), .vid_tuser_i(vid_user),
      .vid_tlast_i(vid_last),
      .surf_tdata_o(surf_data), .surf_tvalid_o(surf_valid), .surf_tready_i(1'b1), .surf_tuser_o(surf_user),
      .surf_tlast_o(surf_last), .irq_o(irq)
  );

  // Handshakes and flags: the board's own outputs, and every net named so.
  `include "flags.svh"
  wire [9:0] outputs = {awready, wready, arready, bvalid, rvalid, vid_ready, surf_valid, irq, 1'b0};
  integer clocks = 0, pc = 0, k, wrong = 0;
  always @(posedge clk) begin
    clocks <= clocks + 1;
    if (clocks % 500 == 0) begin
      $display("clock %0d, step %0d", clocks, pc);
      $fflush;
    end
    if (clocks >= Reset + Settle) begin
      if (^outputs === 1'bx) $fatal(1, "clock %0d: an output is X: %b", clocks, outputs);
      if (surf_valid && ^{surf_data, surf_user, surf_last} === 1'bx) $fatal(1, "clock %0d: a score is X", clocks);
      if (rvalid && ^rresp === 1'bx || bvalid && ^bresp === 1'bx) $fatal(1, "clock %0d: a response is X", clocks);
      if (^flags === 1'bx) begin
        for (k = 0; k < Flags; k = k + 1) if (flags[k] === 1'bx) $display("clock %0d: flag %0d is X", clocks, k);
        wrong = wrong + 1;
        if (wrong == 20) $fatal(1, "flags are X; flags.txt has their names");
      end
    end
  end

  // Cameras
  always @(posedge clk) begin
    for (k = 0; k < 2; k = k + 1) if (sending[k] && vid_ready[k]) begin
      at[k] <= at[k] + 1;
      if (at[k] == Width * Height - 1) sending[k] <= 1'b0;
    end
  end

  // Surface
  integer beats = 0;
  always @(posedge clk) if (!rst && surf_valid) begin
    if (beats == Beats) $fatal(1, "a score too many");
    if ({surf_last, surf_user, surf_data} !== surface[beats])
      $fatal(1, "score %0d is %h, not %h", beats, {surf_last, surf_user, surf_data}, surface[beats]);
    beats <= beats + 1;
  end

  task put(input [7:0] address, input [31:0] data);
    begin
      awaddr  <= address;
      wdata   <= data;
      awvalid <= 1'b1;
      wvalid  <= 1'b1;
      @(posedge clk);
      while (!bvalid) begin
        if (awready) awvalid <= 1'b0;
        if (wready) wvalid <= 1'b0;
        @(posedge clk);
      end
      if (bresp !== 2'b0) $fatal(1, "write of %h is answered with %b", address, bresp);
    end
  endtask

  reg [31:0] got;
  task get(input [7:0] address);
    begin
      araddr  <= address;
      arvalid <= 1'b1;
      @(posedge clk);
      while (!rvalid) begin
        if (arready) arvalid <= 1'b0;
        @(posedge clk);
      end
      got = rdata;
      if (rresp !== 2'b0) $fatal(1, "read of %h is answered with %b", address, rresp);
    end
  endtask

  integer begun;
  reg [7:0] operation;
  reg [15:0] address;
  reg [31:0] data, mask;
  initial begin
    rst     = 1'b1;
    awvalid = 1'b0;
    wvalid  = 1'b0;
    arvalid = 1'b0;
    awaddr  = 8'b0;
    araddr  = 8'b0;
    wdata   = 32'b0;
    sending = 2'b0;
    at[0]   = 0;
    at[1]   = 0;
    repeat (Reset) @(posedge clk);
    rst <= 1'b0;
    repeat (Settle) @(posedge clk);
    operation = 8'hFF;
    for (pc = 0; operation != 0; pc = pc + 1) begin
      {operation, address, data, mask} = steps[pc];
      begun = clocks;
      case (operation)
        0: ;
        1: put(address[7:0], data);
        2: begin
          get(address[7:0]);
          if ((got & mask) !== data)
            $fatal(1, "step %0d: register %h is %h, not %h in bits %h", pc, address, got, data, mask);
        end
        3: begin
          get(address[7:0]);
          while ((got & mask) !== data) begin
            if (clocks - begun > Limit) $fatal(1, "step %0d: register %h stays %h", pc, address, got);
            get(address[7:0]);
          end
        end
        4: begin
          at[address[0]] <= 0;
          sending[address[0]] <= 1'b1;
          @(posedge clk);
        end
        default: $fatal(1, "step %0d: no such operation: %h", pc, operation);
      endcase
    end
    if (beats != Beats) $fatal(1, "%0d scores, not %0d", beats, Beats);
    if (wrong != 0) $fatal(1, "flags are X; flags.txt has their names");
    $display("PASS: %0d steps, %0d scores, %0d flags known in %0d clocks", pc, beats, Flags, clocks - Reset - Settle);
    $finish;
  end
endmodule
