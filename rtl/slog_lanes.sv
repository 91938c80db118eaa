// Moves one operand group from lane to lane and compares it there.
//
//   x[k] = (tpl ^ search[GroupBits-1+k : k]) & mask     for lane k
//
// Template and search row enter lane 0 together and hop one lane per clock; the search row slips one bit per hop, the
// bits that have yet to slip in riding along in ahead_q.
//
// Stage  registers                valid at lane k after the operands' clock
//   1    tpl_q search_q ahead_q   1 + k
//   2    x_q                      2 + k
//
// Throughput : one operand row per clock. Everything holds while move_i is low.
// Borders    : mask_i is static while operands are in flight; a cleared bit never counts.
module slog_lanes #(
    parameter  int unsigned GroupBits  = 8,
    parameter  int unsigned Lanes      = 5,
    localparam int unsigned SearchBits = GroupBits + Lanes - 1
) (
    input  logic                  clk_i,
    input  logic                  move_i,
    input  logic [GroupBits-1:0]  tpl_i,
    input  logic [SearchBits-1:0] search_i,
    input  logic [GroupBits-1:0]  mask_i,
    output logic [GroupBits-1:0]  x_o[Lanes]
);
  logic [GroupBits-1:0] tpl_d[Lanes], tpl_q[Lanes], search_d[Lanes], search_q[Lanes], x_d[Lanes], x_q[Lanes];
  logic [Lanes-2:0] ahead_d[Lanes], ahead_q[Lanes];

  always_comb begin
    tpl_d[0]    = tpl_i;
    search_d[0] = search_i[GroupBits-1:0];
    ahead_d[0]  = search_i[SearchBits-1:GroupBits];
    /* verilator unroll_disable */
    for (int unsigned k = 1; k < Lanes; k++) begin
      tpl_d[k]    = tpl_q[k-1];
      search_d[k] = {ahead_q[k-1][0], search_q[k-1][GroupBits-1:1]};
      ahead_d[k]  = ahead_q[k-1] >> 1;
    end
    /* verilator unroll_disable */
    for (int unsigned k = 0; k < Lanes; k++) x_d[k] = (tpl_q[k] ^ search_q[k]) & mask_i;
  end

  always_ff @(posedge clk_i) begin
    if (move_i) begin
      tpl_q    <= tpl_d;
      search_q <= search_d;
      ahead_q  <= ahead_d;
      x_q      <= x_d;
    end
  end
  assign x_o = x_q;
endmodule : slog_lanes
