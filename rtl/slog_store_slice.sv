// A few bits of every word of the bit-plane store, with address registers of their own.
//
//   stage  registers
//   1      address and write data
//   2, 3   block RAM and its output register (slog_ram)
//   4      bank multiplexer
// Latency    : rd_en_i to data_o 4 clocks, which stays until the next read's.
// Throughput : one read and one write per clock.
// Rule       : a word must not be read in the clock in which it is written.
module slog_store_slice #(
    parameter  int unsigned Width     = 8,
    parameter  int unsigned Words     = 28800,
    parameter  int unsigned BankWords = 16384,
    localparam int unsigned Banks     = (Words + BankWords - 1) / BankWords,
    localparam int unsigned AddrW     = (Banks > 1) ? $clog2(BankWords) : $clog2(Words)
) (
    input  logic             clk_i,
    input  logic [Banks-1:0] wr_en_i,
    input  logic [AddrW-1:0] wr_addr_i,
    input  logic [Width-1:0] wr_data_i,
    input  logic [Banks-1:0] rd_en_i,
    input  logic [AddrW-1:0] rd_addr_i,
    output logic [Width-1:0] data_o
);
  logic [AddrW-1:0] rd_addr_q, wr_addr_q;
  logic [Width-1:0] wr_data_q, data_q;
  logic [Banks-1:0] wr_en_q, rd_en_q, rd_en_q2, rd_en_q3;
  logic [Banks-1:0][Width-1:0] bank_data;
  logic [Width-1:0] chosen;

  always_ff @(posedge clk_i) begin
    wr_en_q   <= wr_en_i;
    wr_addr_q <= wr_addr_i;
    wr_data_q <= wr_data_i;
    rd_en_q   <= rd_en_i;
    rd_addr_q <= rd_addr_i;
    rd_en_q2  <= rd_en_q;
    rd_en_q3  <= rd_en_q2;
    if (rd_en_q3 != '0) data_q <= chosen;
  end

  for (genvar b = 0; b < Banks; b++) begin : g_bank
    localparam int unsigned Depth = (b == Banks - 1) ? Words - b * BankWords : BankWords;
    localparam int unsigned DepthW = $clog2(Depth);
    slog_ram #(
        .Width(Width),
        .Depth(Depth)
    ) u_ram (
        .clk_i,
        .wr_en_i  (wr_en_q[b]),
        .wr_addr_i(wr_addr_q[DepthW-1:0]),
        .wr_data_i(wr_data_q),
        .rd_en_i  (rd_en_q[b]),
        .rd_addr_i(rd_addr_q[DepthW-1:0]),
        .rd_data_o(bank_data[b])
    );
  end

  always_comb begin
    chosen = '0;
    for (int unsigned b = 0; b < Banks; b++) if (rd_en_q3[b]) chosen = bank_data[b];
  end
  assign data_o = data_q;
endmodule : slog_store_slice
