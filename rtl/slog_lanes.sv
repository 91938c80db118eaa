// Moves one operand group from lane to lane and compares it there, bit-sliced: every vector is one bit of all lanes.
//
//   x[b][k] = (tpl[b] ^ search[b + k]) & mask[b]     for lane k of a group's bit b
//
// Template and search row enter lane 0 together and hop one lane per clock; the search row slips one bit per hop.
//
// Stage  registers       valid at lane k after the operands' clock
//   0    late (bit b)    d(b)
//   1    tpl_q search_q  d(b) + 1 + k
//   2    x_q             d(b) + 2 + k
//
// d(b) is 0, or with Stagger levels - bits(b): the clock in which the popcount heap takes bit b as a carry. Smaller b
// are later, so the search row needs an extra delay only where d changes.
// Throughput : one operand row per clock. Everything holds while move_i is low.
// Borders    : mask_i is static while operands are in flight; a cleared bit never counts.
module slog_lanes #(
    parameter  int unsigned GroupBits  = 8,
    parameter  int unsigned Lanes      = 5,
    parameter  bit          Stagger    = 1'b0,
    localparam int unsigned SearchBits = GroupBits + Lanes - 1
) (
    input  logic                  clk_i,
    input  logic                  move_i,
    input  logic [GroupBits-1:0]  tpl_i,
    input  logic [SearchBits-1:0] search_i,
    input  logic [GroupBits-1:0]  mask_i,
    output logic [Lanes-1:0]      x_o[GroupBits]
);
  localparam int unsigned Levels = slog_array_pkg::levels(GroupBits);

  for (genvar d = 0; d <= (Stagger ? Levels : 0); d++) begin : g_late
    localparam int unsigned Kept = GroupBits >> d;
    logic [Kept-1:0] tpl, search;
    if (d == 0) begin : g_now
      assign tpl    = tpl_i;
      assign search = search_i[Kept-1:0];
    end else begin : g_delay
      always_ff @(posedge clk_i) begin
        if (move_i) begin
          tpl    <= g_late[d-1].tpl[Kept-1:0];
          search <= g_late[d-1].search[Kept-1:0];
        end
      end
    end
  end

  for (genvar b = 0; b < SearchBits; b++) begin : g_bit
    // Bits past the group only feed the lanes that will slip them into it.
    localparam int unsigned Width = (b < GroupBits) ? Lanes : SearchBits - b;
    localparam int unsigned Late = (Stagger && b < GroupBits) ? Levels - $clog2(b + 1) : 0;
    localparam int unsigned LateAbove = (Stagger && b + 1 < GroupBits) ? Levels - $clog2(b + 2) : 0;
    logic [Width-1:0] search_q;
    logic search_in;

    if (b < GroupBits) begin : g_in
      assign search_in = g_late[Late].search[b];
    end else begin : g_in
      assign search_in = search_i[b];
    end

    if (Width == 1) begin : g_hop
      always_ff @(posedge clk_i) begin
        if (move_i) search_q <= search_in;
      end
    end else if (Late == LateAbove) begin : g_hop
      always_ff @(posedge clk_i) begin
        if (move_i) search_q <= {g_bit[b+1].search_q[Width-2:0], search_in};
      end
    end else begin : g_hop
      logic [Width-2:0] above_q;
      always_ff @(posedge clk_i) begin
        if (move_i) begin
          above_q  <= g_bit[b+1].search_q[Width-2:0];
          search_q <= {above_q, search_in};
        end
      end
    end

    if (b < GroupBits) begin : g_compare
      logic [Lanes-1:0] tpl_q, x_q;
      always_ff @(posedge clk_i) begin
        if (move_i) begin
          tpl_q <= {tpl_q[Lanes-2:0], g_late[Late].tpl[b]};
          x_q   <= (tpl_q ^ search_q) & {Lanes{mask_i[b]}};
        end
      end
      assign x_o[b] = x_q;
    end
  end
endmodule : slog_lanes
