// Staged filter coefficients and image size, put in use together while no frame is under way.
//
// A commit holds back new frames; when every camera has been idle for Settle clocks in a row, the staged values become the
// active ones and frames flow again. A staged size outside MinImage..MaxWidth x MaxHeight is not taken (size_error_o).
// After reset all coefficients are 0 and the size is the largest.
//
// Latency    : commit to change is Settle + 2 clocks with idle cameras; coefficient k follows k + 1 clocks later, so that
//              one enable need not reach them all, and busy_o falls after the last.
// Formats    : coefficients signed, 2.15 fixed point ([0] = centre); sizes in pixels.
`include "slog_assert.svh"
module slog_filter_bank #(
    parameter int unsigned Cameras   = 2,
    parameter int unsigned Coefs     = 17,
    parameter int unsigned CoefBits  = 18,
    parameter int unsigned MinImage  = 34,
    parameter int unsigned MaxWidth  = 640,
    parameter int unsigned MaxHeight = 480
) (
    input  logic                           clk_i,
    input  logic                           rst_i,
    input  logic                           coef_valid_i,
    input  logic                           coef_second_i,
    input  logic [4:0]                     coef_index_i,
    input  logic [CoefBits-1:0]            coef_value_i,
    input  logic                           commit_i,
    input  logic [9:0]                     width_i,
    input  logic [9:0]                     height_i,
    input  logic [Cameras-1:0]             active_i,        // a frame is under way
    output logic                           hold_o,
    output logic                           busy_o,
    output logic                           size_error_o,
    output logic                           size_changed_o,  // pulse, in the clock in which the new size is first seen
    output logic [9:0]                     width_o,
    output logic [9:0]                     height_o,
    output logic [Coefs-1:0][CoefBits-1:0] g_o,
    output logic [Coefs-1:0][CoefBits-1:0] g2_o
);
  // A frame let in just before the hold needs a few clocks to show as active.
  localparam int unsigned Settle = 8;
  localparam int unsigned SettleW = $clog2(Settle + 1);

  logic [Coefs-1:0][CoefBits-1:0] staged_g_q, staged_g2_q, g_q, g2_q;
  logic [SettleW-1:0] settle_q;
  logic [9:0] width_q, height_q;
  logic busy_q, size_error_q, size_changed_q;
  logic [Coefs-1:0] follow_q;
  logic apply, size_good;

  assign apply = busy_q && settle_q == SettleW'(Settle) && active_i == '0;
  assign size_good = width_i >= 10'(MinImage) && width_i <= 10'(MaxWidth) &&
                     height_i >= 10'(MinImage) && height_i <= 10'(MaxHeight);

  for (genvar k = 0; k < Coefs; k++) begin : g_coef
    always_ff @(posedge clk_i) begin
      if (rst_i) begin
        staged_g_q[k]  <= '0;
        staged_g2_q[k] <= '0;
      end else if (coef_valid_i && coef_index_i == 5'(k)) begin
        if (coef_second_i) staged_g2_q[k] <= coef_value_i;
        else staged_g_q[k] <= coef_value_i;
      end
      if (rst_i) begin
        g_q[k]  <= '0;
        g2_q[k] <= '0;
      end else if (follow_q[k]) begin
        g_q[k]  <= staged_g_q[k];
        g2_q[k] <= staged_g2_q[k];
      end
    end
  end

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      settle_q       <= '0;
      follow_q       <= '0;
      width_q        <= 10'(MaxWidth);
      height_q       <= 10'(MaxHeight);
      busy_q         <= 1'b0;
      size_error_q   <= 1'b0;
      size_changed_q <= 1'b0;
    end else begin
      size_changed_q <= 1'b0;
      follow_q       <= {follow_q[Coefs-2:0], apply};
      if (!busy_q || active_i != '0) settle_q <= '0;
      else if (settle_q != SettleW'(Settle)) settle_q <= settle_q + 1'b1;
      if (apply) begin
        busy_q       <= commit_i;
        size_error_q <= !size_good;
        if (size_good) begin
          width_q        <= width_i;
          height_q       <= height_i;
          size_changed_q <= width_q != width_i || height_q != height_i;
        end
      end else if (commit_i) begin
        busy_q <= 1'b1;
      end
    end
  end

  assign hold_o         = busy_o;
  assign busy_o         = busy_q || follow_q != '0;
  assign size_error_o   = size_error_q;
  assign size_changed_o = size_changed_q;
  assign width_o        = width_q;
  assign height_o       = height_q;
  assign g_o            = g_q;
  assign g2_o           = g2_q;

  `SLOG_ASSERT(SlogFilterBankQuiet, size_changed_o |-> $past(active_i) == '0)
endmodule : slog_filter_bank
