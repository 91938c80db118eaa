// SPDX-License-Identifier: Apache-2.0
// A design of one's own around one block of Signum: counts the positive signs of every camera frame.
//
// The image is 48x36, sigma is 2. ones_o is valid in the clock in which done_o is high.
module my_design (
    input  logic        clk_i,
    input  logic        rst_i,
    input  logic [7:0]  tdata_i,
    input  logic        tvalid_i,
    output logic        tready_o,
    input  logic        tuser_i,
    input  logic        tlast_i,
    output logic        done_o,
    output logic [10:0] ones_o
);
  // Sigma 2 for Radius = 8, as `golden.log.kernels(2.0, 8)` returns it; the last element is the centre.
  localparam logic [8:0][17:0] G = {18'd2, 18'd14, 18'd73, 18'd287, 18'd885, 18'd2122, 18'd3965, 18'd5768, 18'd6536};
  localparam logic [8:0][17:0] G2 = {18'd71, 18'd347, 18'd1254, 18'd3254, 18'd5728, 18'd5727, 18'd3, -18'sd9333,
                                     -18'sd14102};

  logic       word_valid, frame_start, frame_done, frame_abort;
  logic [7:0] word;
  logic       unused_busy, unused_last, unused_accepted, unused_dropped;

  slog_frontend #(.MaxWidth(48), .Radius(8), .GroupBits(8)) u_frontend (
      .clk_i, .rst_i, .tdata_i, .tvalid_i, .tready_o, .tuser_i, .tlast_i,
      .width_i(10'd48), .height_i(10'd36), .g_i(G), .g2_i(G2), .hold_i(1'b0), .abort_i(1'b0), .busy_o(unused_busy),
      .word_valid_o(word_valid), .word_data_o(word), .word_last_o(unused_last), .frame_start_o(frame_start),
      .frame_done_o(frame_done), .frame_abort_o(frame_abort), .accepted_o(unused_accepted), .dropped_o(unused_dropped)
  );

  always_ff @(posedge clk_i) begin
    done_o <= frame_done && !rst_i;
    if (rst_i || frame_start || frame_abort) ones_o <= '0;
    else if (word_valid) ones_o <= ones_o + 11'($countones(word));
  end
endmodule : my_design
