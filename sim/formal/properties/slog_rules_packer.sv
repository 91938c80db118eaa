// SPDX-License-Identifier: Apache-2.0
// slog_packer against a plain shift of bits into words, six clocks later, and what its registers hold of that, which makes
// the proof inductive.
module slog_rules_packer #(
    parameter int unsigned GroupBits = 4,
    parameter int unsigned PlaceW    = 2,
    parameter int unsigned Slices    = 1
) (
    input logic                 clk_i,
    input logic                 rst_i,
    input logic                 bit_valid_i,
    input logic                 bit_i,
    input logic                 bit_last_i,
    input logic                 bit_start_i,
    input logic                 bit_done_i,
    input logic                 bit_abort_i,
    input logic                 word_valid_o,
    input logic [GroupBits-1:0] word_data_o,
    input logic                 word_last_o,
    input logic                 frame_start_o,
    input logic                 frame_done_o,
    input logic                 frame_abort_o,
    input logic                 anew_q,
    input logic                 valid_q2,
    input logic [PlaceW-1:0]    place_q,
    input logic                 fresh_q,
    input logic                 end_q,
    input logic [Slices-1:0]    begin_q
);
  typedef struct packed {
    logic                 valid;
    logic [GroupBits-1:0] word;
    logic                 last;
    logic                 start;
    logic                 done;
    logic                 abort;
  } outputs_t;
  logic [PlaceW-1:0] count_q;             // pixels of the word under way
  logic [4:0][PlaceW-1:0] counts_q;       // [k]: k + 1 clocks ago
  logic [4:0] valids_q;                   // [k]: a pixel came k + 1 clocks ago
  logic [5:0] quiet_q;                    // [k]: no reset for k + 1 clocks
  logic [GroupBits-1:0] word_q, word;
  outputs_t [5:0] wanted_q;
  logic full;
  assign word = word_q | (GroupBits'(bit_i && bit_valid_i) << count_q);
  assign full = bit_valid_i && (bit_last_i || 32'(count_q) == GroupBits - 1);

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      count_q  <= '0;
      counts_q <= '0;
      valids_q <= '0;
      quiet_q  <= '0;
      word_q   <= '0;
      wanted_q <= '0;
    end else begin
      counts_q <= {counts_q[3:0], count_q};
      valids_q <= {valids_q[3:0], bit_valid_i};
      quiet_q  <= {quiet_q[4:0], 1'b1};
      if (full || bit_abort_i) begin
        count_q <= '0;
        word_q  <= '0;
      end else begin
        count_q <= count_q + PlaceW'(bit_valid_i);
        word_q  <= word;
      end
      wanted_q <= {wanted_q[4:0], outputs_t'{valid: full, word: word, last: bit_last_i, start: bit_start_i,
                                             done: bit_done_i, abort: bit_abort_i}};
    end
    if (!rst_i) begin
      RulesPackerFlags : assert ({word_valid_o, frame_start_o, frame_done_o, frame_abort_o}
                                 == {wanted_q[5].valid, wanted_q[5].start, wanted_q[5].done, wanted_q[5].abort});
      RulesPackerWord : assert (!wanted_q[5].valid || (word_data_o == wanted_q[5].word && word_last_o == wanted_q[5].last));
      RulesPackerPlace : assert (anew_q ? !valid_q2 : place_q == counts_q[1] && fresh_q == (place_q == '0)
                                 && end_q == (32'(place_q) == GroupBits - 1));
      RulesPackerPart : assert (!quiet_q[5] || word_data_o == wanted_q[5].word);
      CoverFull : cover (word_valid_o && word_data_o == '1 && !word_last_o);
      CoverPart : cover (word_valid_o && word_last_o && word_data_o == GroupBits'(1));
      CoverAbort : cover (frame_abort_o && $countones(word_q) > 1);
    end
  end

  // Each slice: the place of the last pixel if it is in the slice; of the next one if it will be the slice's first.
  localparam int unsigned Bits = GroupBits / Slices;
  for (genvar s = 0; s < Slices; s++) begin : g_rules
    int unsigned last;
    logic [Bits-1:0] place;
    assign last  = 32'(counts_q[4]) - 32'(!valids_q[4]);
    assign place = (32'(counts_q[4]) == s * Bits) ? Bits'(1) : (last / Bits == s) ? Bits'(1) << last % Bits : '0;
    always_ff @(posedge clk_i) begin
      if (!rst_i) begin
        RulesPackerBegin : assert (anew_q || begin_q[s] == (32'(place_q) == s * Bits));
        RulesPackerSlice : assert (!quiet_q[5] || slog_packer.g_slice[s].u_slice.place_q == place);
      end
    end
  end
endmodule : slog_rules_packer

bind slog_packer slog_rules_packer #(.GroupBits(GroupBits), .PlaceW(PlaceW), .Slices(Slices)) u_rules (.*);
