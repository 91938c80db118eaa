// SPDX-License-Identifier: Apache-2.0
// slog_capture's way to the store, with channels that may do anything their own proof allows: each camera's words are
// written in the order in which its channel pushes them, none is lost, changed or made up; camera 0 goes first.
//
// For the induction there is a second model of the queues at the slices, three clocks behind the first: the slices hold what
// it holds, and with the pushes and pops that are on their way it becomes the first.
module slog_rules_capture_words #(
    parameter int unsigned WordW = 5
) (
    input logic                  clk_i,
    input logic                  rst_i,
    input logic [1:0]            push,
    input logic [1:0]            pop,
    input logic [1:0]            empty,
    input logic [1:0][WordW-1:0] pushed,
    input logic                  wr_valid_o,
    input logic [WordW-1:0]      written,
    input logic [3:0]            wr_valid_q,
    // On the way to the slice, [0] first: pushes, empty flags, words. The slice's own registers are the last.
    input logic [2:0][1:0]            push_way,
    input logic [2:0][1:0]            empty_way,
    input logic [2:0][1:0][WordW-1:0] word_way,
    input logic [1:0][1:0]            head,
    input logic [1:0][1:0]            tail,
    input logic [1:0][3:0][WordW-1:0] held     // the slice's memories
);
  localparam int unsigned Latency = 4;  // clocks from the word's pop to the store's write port
  localparam int unsigned Way     = 3;  // of these, clocks to the slice's queue
  typedef struct packed {
    logic [2:0]            level;
    logic [3:0][WordW-1:0] words;
  } queue_t;

  // A queue after a pop and a push.
  function automatic queue_t after(queue_t was, logic push, logic pop, logic [WordW-1:0] word);
    queue_t now;
    now = was;
    for (int unsigned n = 0; n < 3; n++) if (pop) now.words[n] = was.words[n+1];
    now.level = was.level - 3'(pop);
    for (int unsigned n = 0; n < 4; n++) if (push && 32'(now.level) == n) now.words[n] = word;
    now.level += 3'(push);
    return now;
  endfunction

  // Whether two queues hold the same.
  function automatic logic same(queue_t one, queue_t other);
    same = one.level == other.level && one.level <= 3'd4;
    for (int unsigned n = 0; n < 4; n++) same &= 32'(one.level) <= n || one.words[n] == other.words[n];
  endfunction

  queue_t [1:0] near_q, far_q, near, far;  // near: what far_q becomes; far: what the slice holds
  logic [2:0][1:0] pop_way;
  logic fits;
  logic [1:0][2:0] level_q;
  logic [1:0][3:0][WordW-1:0] queue_q;  // [camera][0]: the oldest word
  always_comb begin
    fits = 1'b1;
    for (int unsigned c = 0; c < 2; c++) begin
      near_q[c] = '{level: level_q[c], words: queue_q[c]};
      near[c]   = far_q[c];
      fits      = 1'b1;
    end
    for (int n = Way - 1; n >= 0; n--) begin
      pop_way[n] = {!empty_way[n][1] && empty_way[n][0], !empty_way[n][0]};
      for (int unsigned c = 0; c < 2; c++) begin
        // A queue that is said to be empty is, and none overflows on the way.
        fits &= empty_way[n][c] == (near[c].level == '0) && !(push_way[n][c] && near[c].level == 3'd4);
        near[c] = after(near[c], push_way[n][c], pop_way[n][c], word_way[n][c]);
      end
    end
    for (int unsigned c = 0; c < 2; c++) begin
      far[c].level = far_q[c].level;
      for (int unsigned n = 0; n < 4; n++) far[c].words[n] = held[c][head[c]+2'(n)];
    end
  end
  always_ff @(posedge clk_i) begin
    for (int unsigned c = 0; c < 2; c++) begin
      if (rst_i) far_q[c].level <= '0;
      else far_q[c] <= after(far_q[c], push_way[Way-1][c], pop_way[Way-1][c], word_way[Way-1][c]);
    end
  end
  logic [Latency-1:0] valid_q;
  logic [Latency-1:0][WordW-1:0] word_q;
  for (genvar c = 0; c < 2; c++) begin : g_camera
    always_ff @(posedge clk_i) begin
      if (rst_i) level_q[c] <= '0;
      else level_q[c] <= level_q[c] + 3'(push[c]) - 3'(pop[c]);
      for (int unsigned n = 0; n < 4; n++) begin
        if (pop[c] && n < 3) queue_q[c][n] <= queue_q[c][(n+1)%4];
        if (push[c] && 32'(level_q[c]) == n + 32'(pop[c])) queue_q[c][n] <= pushed[c];
      end
      if (!rst_i) begin
        AssumeRoom : assume (!push[c] || level_q[c] < 3'd4);
        AssumeEmpty : assume (empty[c] == (level_q[c] == '0));
      end
    end
  end
  always_ff @(posedge clk_i) begin
    valid_q <= rst_i ? '0 : {valid_q[Latency-2:0], empty != '1};
    word_q  <= {word_q[Latency-2:0], empty[0] ? queue_q[1][0] : queue_q[0][0]};
    if (!rst_i) begin
      RulesCaptureFits : assert (fits);
      RulesCaptureNear : assert (same(near[0], near_q[0]) && same(near[1], near_q[1]));
      RulesCaptureFar : assert (same(far[0], far_q[0]) && same(far[1], far_q[1])
                                && tail[0] == head[0] + 2'(far_q[0].level) && tail[1] == head[1] + 2'(far_q[1].level));
      RulesCaptureWay : assert (wr_valid_q == valid_q && valid_q[Way-1:0] == {empty_way[2] != '1, empty_way[1] != '1,
                                                                             empty_way[0] != '1});
      RulesCaptureNext : assert (!valid_q[Way-1] || word_q[Way-1] == (empty_way[2][0] ? far_q[1].words[0]
                                                                                     : far_q[0].words[0]));
      RulesCapturePop : assert (pop == {!empty[1] && empty[0], !empty[0]});
      RulesCaptureWritten : assert (wr_valid_o == valid_q[Latency-1] && (!wr_valid_o || written == word_q[Latency-1]));
      CoverBoth : cover (level_q[0] == 3'd1 && level_q[1] == 3'd4 && wr_valid_o);
      CoverSecondFollows : cover (pop[1] && level_q[1] == 3'd4);
    end
  end
endmodule : slog_rules_capture_words

bind slog_capture slog_rules_capture_words #(.WordW(WordW)) u_rules_words (
    .pushed({g_channel[1].addr, g_channel[1].data, g_channel[0].addr, g_channel[0].data}), .written({wr_addr_o, wr_data_o}),
    .push_way({g_slice[0].u_slice.push_q, push_q[1], push_q[0]}),
    .empty_way({g_slice[0].u_slice.empty_q, empty_q[1], empty_q[0]}),
    .word_way({g_slice[0].u_slice.g_queue[1].word_q, g_slice[0].u_slice.g_queue[0].word_q,
               g_channel[1].addr_q[1], g_channel[1].data_q[1], g_channel[0].addr_q[1], g_channel[0].data_q[1],
               g_channel[1].addr_q[0], g_channel[1].data_q[0], g_channel[0].addr_q[0], g_channel[0].data_q[0]}),
    .head({g_slice[0].u_slice.g_queue[1].head_q, g_slice[0].u_slice.g_queue[0].head_q}),
    .tail({g_slice[0].u_slice.g_queue[1].tail_q, g_slice[0].u_slice.g_queue[0].tail_q}),
    .held({g_slice[0].u_slice.g_queue[1].mem_q[3], g_slice[0].u_slice.g_queue[1].mem_q[2],
           g_slice[0].u_slice.g_queue[1].mem_q[1], g_slice[0].u_slice.g_queue[1].mem_q[0],
           g_slice[0].u_slice.g_queue[0].mem_q[3], g_slice[0].u_slice.g_queue[0].mem_q[2],
           g_slice[0].u_slice.g_queue[0].mem_q[1], g_slice[0].u_slice.g_queue[0].mem_q[0]}),
    .*);
