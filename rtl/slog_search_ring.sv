// Ring of search rows, read as two operand rows of GroupBits + Pitch bits that start at any multiple of Pitch.
//
//   a = units chunk .. chunk+2 of row            b = units chunk+2 .. chunk+4 of row           (wide)
//                                                b = units chunk .. chunk+2 of the next row    (else)
//
// A unit is Pitch = GroupBits/2 bits, a word two units, a quad two words. Word w of row r lies in the memory of row
// parity r[0], quad parity w[1] and word parity w[0], at address {w >> 2, r >> 1}; so two rows and, in each, two
// quads that follow one another are read at once.
//
// Stage  registers          valid after the clock of read_i, wide_i, row_i, chunk_i
//   1    addr_q             1
//   3    RAM output         3
//   4    a_q4[3] b_q4[4]    4: words from the first quad on: rows and quads in place
//   5    a_q5[2] b_q5[2]    5: words from the first unit's on
//   6    a_o b_o            6: units in place; zero unless keep_a_i, keep_b_i were high in the clock before
//
// Throughput : one read and one write per clock.
// Rules      : a word can be read by row_i from the clock after wr_valid_i on, and written again from the clock after
//              its row_i on. Words past a row's end read as anything.
module slog_search_ring #(
    parameter  int unsigned GroupBits   = 8,
    parameter  int unsigned RingRows    = 32,
    parameter  int unsigned WordsPerRow = 6,
    localparam int unsigned Pitch       = GroupBits / 2,
    localparam int unsigned RowW        = $clog2(RingRows)
) (
    input  logic                       clk_i,
    input  logic                       wr_valid_i,
    input  logic [RowW-1:0]            wr_row_i,
    input  logic [3:0]                 wr_word_i,
    input  logic [GroupBits-1:0]       wr_data_i,
    input  logic                       read_i,
    input  logic                       wide_i,
    input  logic [RowW-1:0]            row_i,
    input  logic [4:0]                 chunk_i,
    input  logic                       keep_a_i,
    input  logic                       keep_b_i,
    output logic [GroupBits+Pitch-1:0] a_o,
    output logic [GroupBits+Pitch-1:0] b_o
);
  localparam int unsigned Depth = (RingRows / 2) * ((WordsPerRow + 3) / 4);
  localparam int unsigned AddrW = $clog2(Depth);

  logic       read_q;
  logic       odd_a_q, odd_a_q2, odd_a_q3;  // parity of group A's row
  logic       odd_b_q, odd_b_q2, odd_b_q3;  // parity of group B's row
  logic       wide_q, wide_q2, wide_q3, wide_q4;
  logic [2:0] chunk_q, chunk_q2, chunk_q3;
  logic [1:0] chunk_q4;
  logic       chunk_q5;

  logic             wr_valid_q;
  logic [2:0]       wr_memory_q;
  logic [AddrW-1:0] wr_addr_q;
  logic [GroupBits-1:0] wr_data_q;
  always_ff @(posedge clk_i) begin
    wr_valid_q  <= wr_valid_i;
    wr_memory_q <= {wr_row_i[0], wr_word_i[1:0]};
    wr_addr_q   <= AddrW'({wr_word_i[3:2], wr_row_i[RowW-1:1]});
    wr_data_q   <= wr_data_i;
  end

  always_ff @(posedge clk_i) begin
    read_q   <= read_i;
    odd_a_q  <= row_i[0];
    odd_a_q2 <= odd_a_q;
    odd_a_q3 <= odd_a_q2;
    odd_b_q  <= row_i[0] ^ !wide_i;
    odd_b_q2 <= odd_b_q;
    odd_b_q3 <= odd_b_q2;
    wide_q   <= wide_i;
    wide_q2  <= wide_q;
    wide_q3  <= wide_q2;
    wide_q4  <= wide_q3;
    chunk_q  <= chunk_i[2:0];
    chunk_q2 <= chunk_q;
    chunk_q3 <= chunk_q2;
    chunk_q4 <= chunk_q3[1:0];
    chunk_q5 <= chunk_q4[0];
  end

  // word[row parity][quad parity][word parity]
  logic [GroupBits-1:0] word[2][2][2];
  for (genvar r = 0; r < 2; r++) begin : g_row
    for (genvar q = 0; q < 2; q++) begin : g_quad
      // Of an odd row the even memory holds the next; of an odd quad likewise.
      logic [RowW-2:0]  row_at;
      logic [1:0]       quad_at;
      logic [AddrW-1:0] addr_q;
      assign row_at  = (r == 0) ? row_i[RowW-1:1] + (RowW - 1)'(row_i[0]) : row_i[RowW-1:1];
      assign quad_at = (q == 0) ? chunk_i[4:3] + 2'(chunk_i[2]) : chunk_i[4:3];
      always_ff @(posedge clk_i) addr_q <= AddrW'({quad_at, row_at});
      for (genvar w = 0; w < 2; w++) begin : g_word
        slog_ram #(.Width(GroupBits), .Depth(Depth)) u_ram (
            .clk_i,
            .wr_en_i  (wr_valid_q && wr_memory_q == 3'(4 * r + 2 * q + w)),
            .wr_addr_i(wr_addr_q),
            .wr_data_i(wr_data_q),
            .rd_en_i  (read_q),
            .rd_addr_i(addr_q),
            .rd_data_o(word[r][q][w])
        );
      end
    end
  end

  logic [GroupBits-1:0] a_q4[3], b_q4[4], a_q5[2], b_q5[2];
  always_ff @(posedge clk_i) begin
    a_q4[0] <= word[odd_a_q3][chunk_q3[2]][0];
    a_q4[1] <= word[odd_a_q3][chunk_q3[2]][1];
    a_q4[2] <= word[odd_a_q3][!chunk_q3[2]][0];
    b_q4[0] <= word[odd_b_q3][chunk_q3[2]][0];
    b_q4[1] <= word[odd_b_q3][chunk_q3[2]][1];
    b_q4[2] <= word[odd_b_q3][!chunk_q3[2]][0];
    b_q4[3] <= word[odd_b_q3][!chunk_q3[2]][1];

    a_q5[0] <= chunk_q4[1] ? a_q4[1] : a_q4[0];
    a_q5[1] <= chunk_q4[1] ? a_q4[2] : a_q4[1];
    if (chunk_q4[1] && wide_q4) begin
      b_q5[0] <= b_q4[2];
      b_q5[1] <= b_q4[3];
    end else if (chunk_q4[1] || wide_q4) begin
      b_q5[0] <= b_q4[1];
      b_q5[1] <= b_q4[2];
    end else begin
      b_q5[0] <= b_q4[0];
      b_q5[1] <= b_q4[1];
    end

    if (!keep_a_i) a_o <= '0;
    else if (chunk_q5) a_o <= {a_q5[1], a_q5[0][GroupBits-1:Pitch]};
    else a_o <= {a_q5[1][Pitch-1:0], a_q5[0]};
    if (!keep_b_i) b_o <= '0;
    else if (chunk_q5) b_o <= {b_q5[1], b_q5[0][GroupBits-1:Pitch]};
    else b_o <= {b_q5[1][Pitch-1:0], b_q5[0]};
  end
endmodule : slog_search_ring
