// SPDX-License-Identifier: Apache-2.0
// Ring of search rows, read as two operand rows of GroupBits + Pitch bits that start at any multiple of Pitch.
//
//   a = units chunk .. chunk+2 of row            b = units chunk+2 .. chunk+4 of row           (wide)
//                                                b = units chunk .. chunk+2 of the next row    (not wide)
//
// A unit is Pitch = GroupBits/2 bits, a word two units, a quad two words. Word w of row r lies in the memory of row
// parity r[0], quad parity w[1] and word parity w[0], at address {w >> 2, r >> 1}; so two consecutive rows and, in
// each, two consecutive quads are read at once.
//
// Stage  registers          valid after the clock of wide_i, row_i, chunk_i
//   1    addr_q             1
//   3    RAM output         3
//   3-7  slog_ring_slice    7: a_o, b_o; zero if blank_a_i, blank_b_i or rst_i was high two clocks before
//
// Throughput : one read and one write per clock.
// Rules      : a word whose group is not blanked is not written in the clock of the row_i that reads it: earlier writes
//              are seen, later ones are not. Words past the end of a row are undefined.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_search_ring #(
    parameter  int unsigned GroupBits   = 8,
    parameter  int unsigned RingRows    = 32,
    parameter  int unsigned WordsPerRow = 6,
    localparam int unsigned Pitch       = GroupBits / 2,
    localparam int unsigned RowW        = $clog2(RingRows),
    localparam int unsigned SliceBits   = (Pitch < 4) ? Pitch : 4,
    localparam int unsigned Slices      = Pitch / SliceBits
) (
    input  logic                       clk_i,
    input  logic                       rst_i,
    input  logic                       wr_even_i,  // a word of row 2 * wr_pair_i
    input  logic                       wr_odd_i,   // a word of row 2 * wr_pair_i + 1
    input  logic [RowW-2:0]            wr_pair_i,
    input  logic [3:0]                 wr_word_i,
    input  logic [GroupBits-1:0]       wr_data_i,
    input  logic                       wide_i,
    input  logic [RowW-1:0]            row_i,
    input  logic [4:0]                 chunk_i,
    input  logic                       blank_a_i,
    input  logic                       blank_b_i,
    output logic [GroupBits+Pitch-1:0] a_o,
    output logic [GroupBits+Pitch-1:0] b_o
);
  localparam int unsigned Depth = (RingRows / 2) * ((WordsPerRow + 3) / 4);
  localparam int unsigned AddrW = $clog2(Depth);

  logic       odd_a_q, odd_a_q2;  // parity of group A's row
  logic       odd_b_q, odd_b_q2;  // parity of group B's row
  logic       wide_q, wide_q2;
  logic [2:0] chunk_q, chunk_q2;

  // Separate registers for the memories of each row parity.
  logic [7:0]           wr_en_q;  // one bit for each memory
  logic [AddrW-1:0]     wr_addr_q[2];
  logic [GroupBits-1:0] wr_data_q[2];
  always_ff @(posedge clk_i) begin
    for (int unsigned m = 0; m < 4; m++) begin
      wr_en_q[m]   <= wr_even_i && wr_word_i[1:0] == 2'(m);
      wr_en_q[4+m] <= wr_odd_i && wr_word_i[1:0] == 2'(m);
    end
    if (wr_even_i) begin
      wr_addr_q[0] <= AddrW'({wr_word_i[3:2], wr_pair_i});
      wr_data_q[0] <= wr_data_i;
    end
    if (wr_odd_i) begin
      wr_addr_q[1] <= AddrW'({wr_word_i[3:2], wr_pair_i});
      wr_data_q[1] <= wr_data_i;
    end
  end

  always_ff @(posedge clk_i) begin
    odd_a_q  <= row_i[0];
    odd_a_q2 <= odd_a_q;
    odd_b_q  <= row_i[0] ^ !wide_i;
    odd_b_q2 <= odd_b_q;
    wide_q   <= wide_i;
    wide_q2  <= wide_q;
    chunk_q  <= chunk_i[2:0];
    chunk_q2 <= chunk_q;
  end

  // word[row parity][quad parity][word parity]
  logic [GroupBits-1:0] word[2][2][2];
  for (genvar r = 0; r < 2; r++) begin : g_row
    for (genvar q = 0; q < 2; q++) begin : g_quad
      // If row_i is odd, the next row is in the even memories, one address on; the same holds for quads.
      logic [RowW-2:0]  row_at;
      logic [1:0]       quad_at;
      logic [AddrW-1:0] addr_q;
      assign row_at  = (r == 0) ? row_i[RowW-1:1] + (RowW - 1)'(row_i[0]) : row_i[RowW-1:1];
      assign quad_at = (q == 0) ? chunk_i[4:3] + 2'(chunk_i[2]) : chunk_i[4:3];
      always_ff @(posedge clk_i) addr_q <= AddrW'({quad_at, row_at});
      for (genvar w = 0; w < 2; w++) begin : g_word
        slog_ram #(.Width(GroupBits), .Depth(Depth)) u_ram (
            .clk_i,
            .wr_en_i  (wr_en_q[4*r+2*q+w]),
            .wr_addr_i(wr_addr_q[r]),
            .wr_data_i(wr_data_q[r]),
            .rd_en_i  (1'b1),  // an enable would have to reach all memories in one clock
            .rd_addr_i(addr_q),
            .rd_data_o(word[r][q][w])
        );
      end
    end
  end

  // Each slice takes the same few bits of every unit.
  for (genvar s = 0; s < Slices; s++) begin : g_slice
    logic [7:0][2*SliceBits-1:0] words;
    logic [3*SliceBits-1:0] a, b;
    for (genvar u = 0; u < 2; u++) begin : g_unit
      for (genvar m = 0; m < 8; m++) begin : g_memory
        assign words[m][u*SliceBits+:SliceBits] = word[m/4][m/2%2][m%2][u*Pitch+s*SliceBits+:SliceBits];
      end
    end
    slog_ring_slice #(.UnitBits(SliceBits)) u_slice (
        .clk_i,
        .rst_i,
        .odd_a_i (odd_a_q2),
        .odd_b_i (odd_b_q2),
        .wide_i  (wide_q2),
        .chunk_i (chunk_q2),
        .blank_a_i,
        .blank_b_i,
        .word_i  (words),
        .a_o     (a),
        .b_o     (b)
    );
    for (genvar u = 0; u < 3; u++) begin : g_out
      assign a_o[u*Pitch+s*SliceBits+:SliceBits] = a[u*SliceBits+:SliceBits];
      assign b_o[u*Pitch+s*SliceBits+:SliceBits] = b[u*SliceBits+:SliceBits];
    end
  end

`ifndef SYNTHESIS
  // A word of the group is written in the clock in which it is read.
  function automatic logic written(logic [RowW-1:0] row, logic [4:0] place);
    return (row[0] ? wr_odd_i : wr_even_i) && wr_pair_i == row[RowW-1:1] && 5'(wr_word_i) == place;
  endfunction
  logic clash_a, clash_b;
  logic [5:1] past_clash_a, past_clash_b;  // [k]: k clocks ago
  always_ff @(posedge clk_i) begin
    past_clash_a <= {past_clash_a[4:1], clash_a};
    past_clash_b <= {past_clash_b[4:1], clash_b};
  end
  always_comb begin
    clash_a = written(row_i, 5'(chunk_i[4:1])) || written(row_i, 5'(chunk_i[4:1]) + 5'd1);
    clash_b = wide_i ? written(row_i, 5'(chunk_i[4:1]) + 5'd1) || written(row_i, 5'(chunk_i[4:1]) + 5'd2)
                     : written(row_i + 1'b1, 5'(chunk_i[4:1])) || written(row_i + 1'b1, 5'(chunk_i[4:1]) + 5'd1);
  end
`endif
  `SLOG_ASSERT_INIT(SlogSearchRingSizes, RingRows == 2 ** RowW && RowW >= 2 && GroupBits == 2 * Pitch
                                         && Pitch == Slices * SliceBits && WordsPerRow <= 16)
  `SLOG_ASSERT(SlogSearchRingSameClock, (!past_clash_a[5] || blank_a_i) && (!past_clash_b[5] || blank_b_i))
endmodule : slog_search_ring
