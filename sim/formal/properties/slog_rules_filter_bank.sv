// SPDX-License-Identifier: Apache-2.0
// slog_filter_bank: while it is not busy, the active coefficients are those staged before the last commit, 0 if none was
// since the reset, and so is the size if it is permitted. The size changes only after 13 clocks in a row without an active
// camera, which end two clocks before. Coefficients are staged while no commit is under way.
module slog_rules_filter_bank #(
    parameter int unsigned Cameras   = 2,
    parameter int unsigned Coefs     = 2,
    parameter int unsigned CoefBits  = 2,
    parameter int unsigned MinImage  = 18,
    parameter int unsigned MaxWidth  = 48,
    parameter int unsigned MaxHeight = 36
) (
    input logic                           clk_i,
    input logic                           rst_i,
    input logic                           coef_valid_i,
    input logic                           coef_second_i,
    input logic [4:0]                     coef_index_i,
    input logic [CoefBits-1:0]            coef_value_i,
    input logic                           commit_i,
    input logic [Cameras-1:0]             active_i,
    input logic                           size_changed_o,
    input logic [9:0]                     width_i,
    input logic [9:0]                     height_i,
    input logic                           busy_o,
    input logic                           size_error_o,
    input logic [9:0]                     width_o,
    input logic [9:0]                     height_o,
    input logic [Coefs-1:0][CoefBits-1:0] g_o,
    input logic [Coefs-1:0][CoefBits-1:0] g2_o
);
  logic [Coefs-1:0][CoefBits-1:0] staged_q, staged2_q, active_q, active2_q;
  logic [9:0] width_q, height_q, size_w_q, size_h_q;
  logic [2:0] since_q;                     // clocks since a coefficient was staged
  logic [3:0] idle_q, idle_q2, idle_q3;    // clocks without an active camera before this one; one, two clocks ago
  logic begun_q = 1'b0, permitted;
  assign permitted = 32'(width_i) >= MinImage && 32'(width_i) <= MaxWidth && 32'(height_i) >= MinImage
                     && 32'(height_i) <= MaxHeight;
  always_ff @(posedge clk_i) begin
    begun_q <= begun_q || !rst_i;
    {size_w_q, size_h_q} <= {width_i, height_i};
    {idle_q2, idle_q3}   <= {idle_q, idle_q2};
    if (rst_i) begin
      staged_q  <= '0;
      staged2_q <= '0;
      active_q  <= '0;
      active2_q <= '0;
      width_q   <= 10'(MaxWidth);
      height_q  <= 10'(MaxHeight);
      since_q   <= '1;
      idle_q    <= '0;
    end else begin
      idle_q <= (active_i != '0) ? '0 : (idle_q == '1) ? idle_q : idle_q + 1'b1;
      since_q <= coef_valid_i ? '0 : (since_q == '1) ? since_q : since_q + 1'b1;
      for (int unsigned k = 0; k < Coefs; k++) begin
        if (coef_valid_i && !coef_second_i && 32'(coef_index_i) == k) staged_q[k] <= coef_value_i;
        if (coef_valid_i && coef_second_i && 32'(coef_index_i) == k) staged2_q[k] <= coef_value_i;
      end
      if (commit_i) begin
        active_q  <= staged_q;
        active2_q <= staged2_q;
        if (permitted) {width_q, height_q} <= {width_i, height_i};
      end
    end
    AssumeNoReset : assume (!begun_q || !rst_i);
    if (!rst_i) begin
      AssumeQuiet : assume (!(busy_o || commit_i) || !coef_valid_i);
      AssumeStaged : assume (!commit_i || (since_q == '1 && !busy_o));
      AssumeSizeStays : assume (!busy_o || {width_i, height_i} == {size_w_q, size_h_q});
      RulesFilterBankActive : assert (busy_o || (g_o == active_q && g2_o == active2_q));
      RulesFilterBankSize : assert (busy_o || (width_o == width_q && height_o == height_q));
      RulesFilterBankIdle : assert (!size_changed_o || idle_q3 >= 4'd13);
      CoverNew : cover (!busy_o && g_o[0] == '1 && g2_o[Coefs-1] == CoefBits'(1) && g_o[Coefs-1] == CoefBits'(2));
      CoverRefused : cover (!busy_o && size_error_o);
    end
  end
endmodule : slog_rules_filter_bank

bind slog_filter_bank slog_rules_filter_bank #(.Cameras(Cameras), .Coefs(Coefs), .CoefBits(CoefBits),
    .MinImage(MinImage), .MaxWidth(MaxWidth), .MaxHeight(MaxHeight)) u_rules (.*);
