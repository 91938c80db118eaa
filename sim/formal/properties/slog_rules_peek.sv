// SPDX-License-Identifier: Apache-2.0
// slog_peek: the value offered to the next read is the part of the store's word that is next in order, or zero.
//
// The host's accesses are five clocks apart or more (slog_axil). One word of the store is watched.
//
// For the induction: the address that follows an access, the word in work, which is in one place from its address to its
// last read, and the registers that hold it.
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
    input logic                 done_q,
    input logic                 go_q,
    input logic                 started_q,
    input logic                 onward_q,
    input logic                 first_q,
    input logic                 new_q,
    input logic                 new_q2,
    input logic                 want_q,
    input logic                 valid_q,
    input logic                 outside_q,
    input logic                 drop_q,
    input logic                 have_q,
    input logic                 zero_q,
    input logic                 in_store_q,
    input logic [23:0]          address_q,
    input logic [23:0]          past_address,
    input logic [Chunks-1:0]    load_q,
    input logic [Chunks-1:0][31:0] word_q,
    input logic [(Chunks>1 ? $clog2(Chunks) : 1)-1:0] chunk_q
);
  logic [AddrW-1:0] choice, asked_q;
  logic [GroupBits-1:0] word;
  slog_rules_choice #(.Width(AddrW)) u_choice (.clk_i, .choice);
  slog_rules_choice #(.Width(GroupBits)) u_word (.clk_i, .choice(word));
  logic begun_q;                  // an address was set
  logic [23:0] place_q;
  logic [1:0] part_q;
  logic [2:0] since_q, ready_q;   // clocks since the last access; for which ready_o has been high since
  logic access, known, was_reset_q;
  logic reading;                  // a read is in progress whose word will be shown
  logic in_range;                   // address_q lies in the store
  logic [Chunks-1:0] loaded;      // part c of the word is loaded, and is that of the watched word
  assign reading = flight_q && !drop_q;
  assign in_range  = 32'(address_q) < StoreWords;
  always_comb begin
    for (int unsigned c = 0; c < Chunks; c++) begin
      loaded[c] = word_q[c] == 32'(64'(word) >> (32 * c));
      for (int unsigned n = 0; n <= c; n++) if (load_q[n]) loaded[c] = 1'b1;
    end
  end
  logic [31:0] wanted;
  assign access = go_i || take_i;
  assign known  = !begun_q || 32'(place_q) >= StoreWords || place_q == 24'(choice);
  assign wanted = (!begun_q || 32'(place_q) >= StoreWords) ? '0 : 32'({32'd0, word} >> (32 * part_q));
  always_ff @(posedge clk_i) begin
    was_reset_q <= rst_i;
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
      RulesPeekTurn : assert ((!(go_q || onward_q) || (since_q == '0 && ready_q == '0)) && !(go_q && onward_q)
                              && (!new_q || since_q == 3'd1) && (!new_q2 || since_q == 3'd2) && begun_q == (started_q || go_q));
      RulesPeekAddress : assert (!begun_q || ((go_q || (new_q && first_q)) ? past_address == place_q :
                                              (onward_q || new_q) ? place_q == address_q + 1'b1 : place_q == address_q));
      RulesPeekPart : assert (!begun_q || ((go_q || onward_q) ? part_q == '0 : 2'(chunk_q) == part_q));
      RulesPeekParts : assert (!begun_q || 32'(part_q) < Chunks);
      RulesPeekInside : assert (new_q2 || was_reset_q || in_store_q == in_range);
      RulesPeekPlace : assert (begun_q ? $onehot({new_q, new_q2, want_q, valid_q, outside_q, reading, have_q})
                                         && !((go_q || onward_q) && (new_q || new_q2)) && (!onward_q || have_q)
                                       : have_q && !({new_q, new_q2, want_q, valid_q, outside_q, flight_q, onward_q} != '0));
      RulesPeekFlight : assert ((!drop_q || (flight_q && (new_q || new_q2 || want_q))) && (!done_q || flight_q) && !(flight_q && valid_q)
                                && !(load_q[0] && valid_q));
      RulesPeekOutside : assert ((!outside_q || !in_range) && (!valid_q || in_range));
      RulesPeekReading : assert (!(reading || (have_q && !zero_q)) || (24'(asked_q) == address_q && in_range));
      RulesPeekZero : assert (begun_q ? !have_q || go_q || zero_q == !in_range : zero_q);
      RulesPeekLoading : assert (!have_q || ((!load_q[0] || ready_q == '0) && (!load_q[Chunks-1] || 32'(ready_q) < Chunks)));
      RulesPeekReadyHas : assert (ready_q < 3'd2 || have_q);
      RulesPeekWord : assert (!(have_q && !zero_q && asked_q == choice) || loaded == '1);
      CoverSecond : cover (32'(ready_q) >= Chunks + 2 && known && begun_q && place_q == 24'd1 && wanted != '0);
      CoverLastPart : cover (32'(ready_q) >= Chunks + 2 && known && wanted != '0 && 32'(part_q) == Chunks - 1);
      CoverPastEnd : cover (32'(ready_q) >= Chunks + 2 && begun_q && 32'(place_q) == StoreWords);
      CoverAgain : cover (go_i && flight_q && place_q == 24'd1);
    end
  end
endmodule : slog_rules_peek

bind slog_peek slog_rules_peek #(.GroupBits(GroupBits), .StoreWords(StoreWords), .AddrW(AddrW), .Chunks(Chunks))
    u_rules (.*);
