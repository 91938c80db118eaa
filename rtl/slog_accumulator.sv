// Adds up each lane's counts over a pass, bit-sliced and skewed like the counts.
//
//   total[k] = (first ? 0 : total[k]) + count[k] + extra[k]
//
// Slice i adds bit i of total and count and the registered carry of slice i-1; extra is the carry into slice 0.
//
// Latency    : total bit i holds a row's sum 1 clock after count bit i came, which is i clocks after bit 0.
// Throughput : one row per lane and clock. Everything holds while move_i is low.
// Formats    : total unsigned, never above 2**ScoreBits - 1 within a pass.
// first_i[i] is the wave of pass starts: bit i is lane 0 of slice i, bit i + k lane k of slice i.
module slog_accumulator #(
    parameter  int unsigned CountBits = 4,
    parameter  int unsigned ScoreBits = 9,
    parameter  int unsigned Lanes     = 5,
    localparam int unsigned WaveBits  = ScoreBits + Lanes - 1
) (
    input  logic                clk_i,
    input  logic                move_i,
    input  logic [WaveBits-1:0] first_i,
    input  logic [Lanes-1:0]    extra_i,
    input  logic [Lanes-1:0]    count_i[CountBits],
    output logic [Lanes-1:0]    total_o[ScoreBits]
);
  for (genvar i = 0; i < ScoreBits; i++) begin : g_slice
    logic [Lanes-1:0] total_q, held, count, carry_in;
    assign held = total_q & ~first_i[i+:Lanes];

    if (i < CountBits) begin : g_count
      assign count = count_i[i];
    end else begin : g_count
      assign count = '0;
    end

    if (i == 0) begin : g_in
      assign carry_in = extra_i;
    end else begin : g_in
      assign carry_in = g_slice[i-1].g_carry.carry_q;
    end

    always_ff @(posedge clk_i) begin
      if (move_i) total_q <= held ^ count ^ carry_in;
    end

    if (i < ScoreBits - 1) begin : g_carry
      logic [Lanes-1:0] carry_q;
      always_ff @(posedge clk_i) begin
        if (move_i) carry_q <= (held & count) | (carry_in & (held ^ count));
      end
    end

    assign total_o[i] = total_q;
  end
endmodule : slog_accumulator
