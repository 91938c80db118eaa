// Staged filter coefficients and image size, put in use together while no frame is under way.
//
// A commit holds back new frames; when every camera has been idle for Settle clocks in a row, the staged values become the
// active ones and frames flow again. A staged size outside MinImage..MaxWidth x MaxHeight is not taken (size_error_o).
// After reset all coefficients are 0 and the size is the largest.
//
// Latency    : commit to change is Settle + 3 clocks with idle cameras; coefficient k follows k + 1 clocks later, so that
//              one enable need not reach them all, and busy_o falls with the last. A coefficient is staged in 2 clocks.
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

  logic [Coefs-1:0][CoefBits-1:0] staged_g_q, staged_g2_q, g_q, g2_q;
  logic [Coefs-1:0] index_q;  // the coefficient that coef_q is for
  logic stage_g_q, stage_g2_q;
  logic [CoefBits-1:0] coef_q;
  logic calm, calm_q;          // a commit waits and no camera is active; was so in the clock before
  logic [Settle-3:0] quiet_q;  // [k]: in k + 1 clocks before that
  logic ready_q;               // in Settle clocks
  logic [9:0] width_q, height_q, new_width_q, new_height_q;
  logic pending_q, busy_q, apply_q, size_error_q, size_changed_q;
  logic [1:0] within_q;      // the staged width, height may be taken
  logic [1:0] differs_q;     // its width, its height is another than the active one
  logic [Coefs-1:0] follow_q;
  logic follow_on_q;  // follow_q is not 0, nor will it be in the next clock
  logic apply, size_new;

  assign size_new = apply_q && within_q == '1 && differs_q != '0;
  assign calm = pending_q && active_i == '0;
  assign apply = ready_q && active_i == '0;

  always_ff @(posedge clk_i) begin
    coef_q <= coef_value_i;
    for (int unsigned k = 0; k < Coefs; k++) index_q[k] <= coef_index_i == 5'(k);
    if (rst_i) begin
      stage_g_q  <= 1'b0;
      stage_g2_q <= 1'b0;
    end else begin
      stage_g_q  <= coef_valid_i && !coef_second_i;
      stage_g2_q <= coef_valid_i && coef_second_i;
    end
  end

  for (genvar k = 0; k < Coefs; k++) begin : g_coef
    always_ff @(posedge clk_i) begin
      if (rst_i) begin
        staged_g_q[k]  <= '0;
        staged_g2_q[k] <= '0;
      end else begin
        if (stage_g_q && index_q[k]) staged_g_q[k] <= coef_q;
        if (stage_g2_q && index_q[k]) staged_g2_q[k] <= coef_q;
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

  // The staged size, as it was in the clock of apply, and whether it may be taken.
  always_ff @(posedge clk_i) begin
    new_width_q  <= width_i;
    new_height_q <= height_i;
    within_q  <= {height_i >= 10'(MinImage) && height_i <= 10'(MaxHeight),
                  width_i >= 10'(MinImage) && width_i <= 10'(MaxWidth)};
    differs_q <= {height_i != height_q, width_i != width_q};
  end

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      calm_q         <= 1'b0;
      quiet_q        <= '0;
      ready_q        <= 1'b0;
      follow_q       <= '0;
      width_q        <= 10'(MaxWidth);
      height_q       <= 10'(MaxHeight);
      pending_q      <= 1'b0;
      follow_on_q    <= 1'b0;
      busy_q         <= 1'b0;
      apply_q        <= 1'b0;
      size_error_q   <= 1'b0;
      size_changed_q <= 1'b0;
    end else begin
      follow_q       <= {follow_q[Coefs-2:0], apply_q};
      calm_q         <= calm;
      quiet_q        <= calm_q ? {quiet_q[Settle-4:0], 1'b1} : '0;
      ready_q        <= calm && calm_q && quiet_q[Settle-3] && !ready_q;
      apply_q        <= apply;
      pending_q      <= commit_i || (pending_q && !apply);
      busy_q         <= commit_i || pending_q || apply_q || follow_on_q;
      follow_on_q    <= apply_q || follow_q[Coefs-3:0] != '0;
      size_changed_q <= size_new;
      if (apply_q) size_error_q <= within_q != '1;
      if (size_new) begin
        width_q  <= new_width_q;
        height_q <= new_height_q;
      end
    end
  end

  assign hold_o         = busy_q;
  assign busy_o         = busy_q;
  assign size_error_o   = size_error_q;
  assign size_changed_o = size_changed_q;
  assign width_o        = width_q;
  assign height_o       = height_q;
  assign g_o            = g_q;
  assign g2_o           = g2_q;

  `SLOG_ASSERT(SlogFilterBankQuiet, size_changed_o |-> $past(active_i, 2) == '0 && busy_o)
  `SLOG_ASSERT(SlogFilterBankBusy, busy_o == (pending_q || apply_q || follow_q != '0))
endmodule : slog_filter_bank
