// SPDX-License-Identifier: Apache-2.0
// slog_peek: the value offered to the next read is the part of the store's word that is next in order, or zero.
//
// The host's accesses are five clocks apart or more (slog_axil). One word of the store is watched.
module slog_rules_peek #(
    parameter int unsigned GroupBits  = 8,
    parameter int unsigned StoreWords = 3,
    parameter int unsigned AddrW      = 2,
    parameter int unsigned Chunks     = 1
) (
    input logic                 clk_i,
    input logic                 rst_i,
    input logic                 go_i,
    input logic [23:0]          address_i,
    input logic                 take_i,
    input logic                 ready_o,
    input logic [31:0]          data_o,
    input logic                 peek_valid_o,
    input logic                 peek_ready_i,
    input logic [AddrW-1:0]     peek_addr_o,
    input logic                 peek_done_i,
    input logic [GroupBits-1:0] peek_data_i,
    input logic                 flight_q,
    input logic                 done_q
);
  logic [AddrW-1:0] choice, asked_q;
  logic [GroupBits-1:0] word;
  slog_rules_choice #(.Width(AddrW)) u_choice (.clk_i, .choice);
  slog_rules_choice #(.Width(GroupBits)) u_word (.clk_i, .choice(word));
  logic begun_q;                  // an address was set
  logic [23:0] place_q;
  logic [1:0] part_q;
  logic [2:0] since_q, ready_q;   // clocks since the last access; for which ready_o has been high since
  logic access, known;
  logic [31:0] wanted;
  assign access = go_i || take_i;
  assign known  = !begun_q || 32'(place_q) >= StoreWords || place_q == 24'(choice);
  assign wanted = (!begun_q || 32'(place_q) >= StoreWords) ? '0 : 32'({32'd0, word} >> (32 * part_q));
  always_ff @(posedge clk_i) begin
    if (peek_valid_o && peek_ready_i) asked_q <= peek_addr_o;
    if (rst_i) begin
      begun_q <= 1'b0;
      since_q <= '1;
      ready_q <= '0;
    end else begin
      since_q <= access ? '0 : (since_q == '1) ? since_q : since_q + 1'b1;
      ready_q <= (access || !ready_o) ? '0 : (ready_q == '1) ? ready_q : ready_q + 1'b1;
      if (go_i) begin
        begun_q <= 1'b1;
        place_q <= address_i;
        part_q  <= '0;
      end else if (take_i && begun_q) begin
        part_q <= (32'(part_q) == Chunks - 1) ? '0 : part_q + 1'b1;
        if (32'(part_q) == Chunks - 1) place_q <= place_q + 1'b1;
      end
    end
    AssumeChoice : assume (32'(choice) < StoreWords);
    if (!rst_i) begin
      AssumeApart : assume (!access || since_q >= 3'd4);
      AssumeOne : assume (!(go_i && take_i));
      AssumeReady : assume (!take_i || ready_o);
      AssumeDone : assume (!peek_done_i || (flight_q && !done_q));
      AssumeData : assume (!peek_done_i || asked_q != choice || peek_data_i == word);
      RulesPeekInStore : assert (!peek_valid_o || 32'(peek_addr_o) < StoreWords);
      RulesPeekData : assert (32'(ready_q) < Chunks + 2 || !known || data_o == wanted);
      CoverSecond : cover (32'(ready_q) >= Chunks + 2 && known && begun_q && place_q == 24'd1 && wanted != '0);
      CoverLastPart : cover (32'(ready_q) >= Chunks + 2 && known && wanted != '0 && 32'(part_q) == Chunks - 1);
      CoverPastEnd : cover (32'(ready_q) >= Chunks + 2 && begun_q && 32'(place_q) == StoreWords);
      CoverAgain : cover (go_i && flight_q && place_q == 24'd1);
    end
  end
endmodule : slog_rules_peek

bind slog_peek slog_rules_peek #(.GroupBits(GroupBits), .StoreWords(StoreWords), .AddrW(AddrW), .Chunks(Chunks))
    u_rules (.*);
