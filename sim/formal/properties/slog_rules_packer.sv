// SPDX-License-Identifier: Apache-2.0
// slog_packer against a plain shift of bits into words, six clocks later.
module slog_rules_packer #(
    parameter int unsigned GroupBits = 4,
    parameter int unsigned PlaceW    = 2
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
    input logic [PlaceW-1:0]    place_q
);
  typedef struct packed {
    logic                 valid;
    logic [GroupBits-1:0] word;
    logic                 last;
    logic                 start;
    logic                 done;
    logic                 abort;
  } outputs_t;
  logic [PlaceW-1:0] count_q, count_q2, count_q3;  // pixels of the word under way; one, two clocks ago
  logic [GroupBits-1:0] word_q, word;
  outputs_t [5:0] wanted_q;
  logic full;
  assign word = word_q | (GroupBits'(bit_i && bit_valid_i) << count_q);
  assign full = bit_valid_i && (bit_last_i || 32'(count_q) == GroupBits - 1);

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      count_q  <= '0;
      count_q2 <= '0;
      count_q3 <= '0;
      word_q   <= '0;
      wanted_q <= '0;
    end else begin
      count_q2 <= count_q;
      count_q3 <= count_q2;
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
      RulesPackerPlace : assert (anew_q || place_q == count_q3);
      CoverFull : cover (word_valid_o && word_data_o == '1 && !word_last_o);
      CoverPart : cover (word_valid_o && word_last_o && word_data_o == GroupBits'(1));
      CoverAbort : cover (frame_abort_o && $countones(word_q) > 1);
    end
  end
endmodule : slog_rules_packer

bind slog_packer slog_rules_packer #(.GroupBits(GroupBits), .PlaceW(PlaceW)) u_rules (.*);
