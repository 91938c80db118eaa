// Brings the lanes' totals out, one per clock: lane k's total is complete one clock after lane k-1's.
//
//   mismatch = total of lane 0, 1, .. lanes-1, in that order
//
// Stage  registers                    valid after the clock of last_i
//   1    token_q of slice 0, lane 0   1 (slice i: 1 + i; lane k: + k): marks the total to take in that clock
//   2    pair_q                       2 + i: AND-OR of two lanes
//   3    few_q                        3 + i: OR of four pairs
//   4    bit_q                        4 + i: OR of all
//   -    early_q                      the lower bits wait for the top one: 3 + ScoreBits
//
// Latency    : last_i to mismatch_valid_o of lane 0: 3 + ScoreBits clocks.
// Throughput : one score per clock; a pass's last_i comes at least lanes clocks after the one before.
// Formats    : mismatch unsigned; lanes 1..Lanes. mismatch_o is 0 while mismatch_valid_o is low.
`include "slog_assert.svh"
module slog_emit #(
    parameter  int unsigned ScoreBits = 9,
    parameter  int unsigned Lanes     = 5,
    localparam int unsigned LaneW     = $clog2(Lanes + 1)
) (
    input  logic                 clk_i,
    input  logic                 rst_i,
    input  logic                 move_i,
    input  logic                 last_i,
    input  logic [LaneW-1:0]     lanes_i,
    input  logic [Lanes-1:0]     total_i[ScoreBits],
    output logic                 mismatch_valid_o,
    output logic [ScoreBits-1:0] mismatch_o
);
  localparam int unsigned Pairs = (Lanes + 1) / 2;
  localparam int unsigned Fews  = (Pairs + 3) / 4;

  logic [LaneW-1:0] left_q;  // lanes to come after the one marked now
  logic more_q;              // left_q is not 0
  logic [ScoreBits+2:0] valid_q;

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      left_q  <= '0;
      more_q  <= 1'b0;
      valid_q <= '0;
    end else if (move_i) begin
      valid_q <= {valid_q[ScoreBits+1:0], last_i || more_q};
      if (last_i) begin
        left_q <= lanes_i - 1'b1;
        more_q <= lanes_i != LaneW'(1);
      end else if (more_q) begin
        left_q <= left_q - 1'b1;
        more_q <= left_q != LaneW'(1);
      end
    end
  end

  for (genvar i = 0; i < ScoreBits; i++) begin : g_slice
    logic [Lanes-1:0] token_q;
    logic [2*Pairs-1:0] taken;
    logic [Pairs-1:0] pair_q;
    logic [4*Fews-1:0] pairs;
    logic [Fews-1:0] few_q;
    logic bit_q;
    logic [i:0] bits;

    if (i == 0) begin : g_token
      always_ff @(posedge clk_i) begin
        if (rst_i) token_q <= '0;
        else if (move_i) token_q <= {token_q[Lanes-2:0] & {(Lanes - 1){more_q}}, last_i};
      end
    end else begin : g_token
      always_ff @(posedge clk_i) begin
        if (rst_i) token_q <= '0;
        else if (move_i) token_q <= g_slice[i-1].token_q;
      end
    end

    assign taken = (2 * Pairs)'(token_q & total_i[i]);
    assign pairs = (4 * Fews)'(pair_q);
    always_ff @(posedge clk_i) begin
      if (move_i) begin
        pair_q <= taken[Pairs-1:0] | taken[2*Pairs-1:Pairs];
        few_q  <= pairs[Fews-1:0] | pairs[2*Fews-1:Fews] | pairs[3*Fews-1:2*Fews] | pairs[4*Fews-1:3*Fews];
        bit_q  <= |few_q;
      end
    end

    if (i == 0) begin : g_bits
      assign bits = bit_q;
    end else begin : g_bits
      logic [i-1:0] early_q;
      always_ff @(posedge clk_i) begin
        if (move_i) early_q <= g_slice[i-1].bits;
      end
      assign bits = {bit_q, early_q};
    end
  end

  assign mismatch_valid_o = valid_q[ScoreBits+2];
  assign mismatch_o       = g_slice[ScoreBits-1].bits;

  `SLOG_ASSERT(SlogEmitOnePass, !(last_i && move_i && more_q))
  `SLOG_ASSERT(SlogEmitLanes, !(last_i && move_i) || (lanes_i != '0 && lanes_i <= LaneW'(Lanes)))
endmodule : slog_emit
