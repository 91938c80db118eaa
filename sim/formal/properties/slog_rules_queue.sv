// SPDX-License-Identifier: Apache-2.0
// What every queue and stage promises: words leave in the order in which they came, none is lost, none is made up, and
// no more than Depth are inside.
//
// One word is watched: the proof holds for every choice of it, because choice may be anything.
module slog_rules_queue #(
    parameter int unsigned Width = 4,
    parameter int unsigned Depth = 4
) (
    input logic             clk_i,
    input logic             rst_i,
    input logic             push,
    input logic [Width-1:0] in_data,
    input logic             offered,
    input logic             pop,
    input logic [Width-1:0] out_data
);
  localparam int unsigned CountW = $clog2(Depth + 1);
  logic [3:0] choice;  // number of the watched word, modulo 16
  slog_rules_choice #(.Width(4)) u_choice (.clk_i, .choice);

  logic [3:0] number_q;         // of the next word pushed
  logic [CountW-1:0] inside_q;  // words inside
  logic watching_q;             // the watched word is inside
  logic [CountW-1:0] ahead_q;   // words before it
  logic [Width-1:0] word_q;     // the watched word
  logic chosen;
  assign chosen = push && number_q == choice;

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      number_q   <= '0;
      inside_q   <= '0;
      watching_q <= 1'b0;
    end else begin
      if (push) number_q <= number_q + 1'b1;
      inside_q <= inside_q + CountW'(push) - CountW'(pop);
      if (chosen && !watching_q) begin
        watching_q <= 1'b1;
        word_q     <= in_data;
        ahead_q    <= inside_q - CountW'(pop);
      end else if (pop) begin
        if (ahead_q == '0) watching_q <= 1'b0;
        ahead_q <= ahead_q - 1'b1;
      end
    end
    if (!rst_i) begin
      RulesQueueNoneMadeUp : assert (!offered || inside_q != '0);
      RulesQueueNotOverfull : assert (32'(inside_q) <= Depth && !(push && !pop && 32'(inside_q) == Depth));
      RulesQueueOrder : assert (!(watching_q && ahead_q == '0 && offered) || out_data == word_q);
      RulesQueueWatched : assert (!watching_q || ahead_q < inside_q);
      CoverFull : cover (32'(inside_q) == Depth);
      CoverWatchedLast : cover (watching_q && 32'(ahead_q) == Depth - 1);
      CoverThrough : cover (watching_q && pop && ahead_q == '0 && push);
    end
  end
endmodule : slog_rules_queue
