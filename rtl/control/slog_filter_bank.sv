// SPDX-License-Identifier: Apache-2.0
// Staged filter coefficients and image size, activated together while no frame is being processed.
//
// A commit holds back new frames; when every camera has been idle for Settle clocks in a row, the staged values become the
// active ones and new frames are let in. A staged size outside MinImage..MaxWidth x MaxHeight is not applied (size_error_o).
// After reset all coefficients become 0 in the same way, and the size is the largest.
//
// Staged coefficients are held in a small memory. The active ones form a shift register across the device, each near its
// multipliers. They are shifted in, the last one first, and the shift enable travels from the end of the chain to its
// start; g2 is one clock behind g. Memory and chain lie far from their control: pipeline registers lie in between.
//
// Latency    : commit to the new size is Settle + 3 clocks with idle cameras, to the last coefficient 3 * Coefs + 2 more;
//              busy_o falls 2 clocks after that, also after reset. hold_o[c] follows busy_o by c + 1 clocks. A coefficient
//              of g is staged in 4 clocks, of g2 in 5.
// Formats    : coefficients signed, 2.15 fixed point ([0] = centre); sizes in pixels.
// Reset      : rst_i is held for 1 clock or more.
`include "slog_assert.svh"
module slog_filter_bank #(
    parameter int unsigned Cameras   = 2,
    parameter int unsigned Coefs     = 17,
    parameter int unsigned CoefBits  = 18,
    parameter int unsigned MinImage  = 34,
    parameter int unsigned MaxWidth  = 640,
    parameter int unsigned MaxHeight = 480
) (
    input  logic                           clk_i,
    input  logic                           rst_i,
    input  logic                           coef_valid_i,
    input  logic                           coef_second_i,
    input  logic [4:0]                     coef_index_i,
    input  logic [CoefBits-1:0]            coef_value_i,
    input  logic                           commit_i,
    input  logic [9:0]                     width_i,
    input  logic [9:0]                     height_i,
    input  logic [Cameras-1:0]             active_i,        // a frame is being received or processed
    output logic [Cameras-1:0]             hold_o,
    output logic                           busy_o,
    output logic                           size_error_o,
    output logic                           size_changed_o,  // pulse in the first clock of the new size
    output logic [9:0]                     width_o,
    output logic [9:0]                     height_o,
    output logic [Coefs-1:0][CoefBits-1:0] g_o,
    output logic [Coefs-1:0][CoefBits-1:0] g2_o
);
  // hold_o reaches the cameras after some clocks, and a frame let in just before that sets active_i a few clocks later.
  localparam int unsigned Settle = 12;
  localparam int unsigned Places = 32;
  localparam int unsigned PulseW = $clog2(2 * Coefs + 1);
  localparam int unsigned PlaceW = (Coefs > 8) ? $clog2(Coefs) : 3;
  localparam int unsigned Fours  = (Coefs + 3) / 4;

  typedef struct packed {
    logic                valid;
    logic                second;
    logic [4:0]          index;
    logic [CoefBits-1:0] value;
  } coef_t;

  // Staging.
  logic [CoefBits-1:0] staged_g_q[Places], staged_g2_q[Places];
  logic [Coefs-1:0] given_g_q, given_g2_q;  // [k]: coefficient k was staged since the reset; else it is 0
  coef_t coef_q[4];                         // pipeline to the memories: g's is written from [2], g2's from [3]
  logic for_g_q, for_g2_q;                  // coef_q[1], coef_q[2] is for that memory
  logic stage_g_q, stage_g2_q;              // coef_q[2], coef_q[3] is
  logic [Coefs-1:0] found_g_q, found_g2_q;  // [k]: it goes to place k
  // Loading.
  logic [Coefs-1:0][CoefBits-1:0] g_q, g2_q;
  logic [PlaceW-1:0] place_q;                // the coefficients that are read
  logic [CoefBits-1:0] read_g_q, read_g2_q;
  logic [Fours-1:0][3:0] given_g, given_g2;  // given_g_q, given_g2_q by fours
  logic [PlaceW-1:2] four_q;                 // the four of the coefficients that are read
  logic [Fours-1:0] read_given_g_q, read_given_g2_q;  // [f]: whether it was staged, if it is of four f
  logic [CoefBits-1:0] next_g_q, next_g2_q;  // inputs of the chains' first coefficients
  logic end_g_q, end_g2_q;                   // the last shift of each chain takes place
  logic ended_q, ended_q2;                   // end_g2_q one, two clocks later
  logic [PulseW-1:0] pulse_q;  // counts shifts to come: at an even number one of g begins, at an odd one of g2
  logic begin_g_q, begin_g_q2, begin_g2_q, begin_g2_q2;  // a shift begins, one and two clocks later
  logic [Coefs-1:0] shift_g, shift_g_q, shift_g2_q;  // [k]: coefficient k takes the value of k - 1; one in two clocks
  logic stay_q;                // !shift_g_q[1], a copy: the next place is not read yet
  logic loading_q, clear_q;    // clear_q: load zeros, after reset
  logic loading;
  // Commit.
  logic active_q;
  logic calm;                  // a commit waits and no camera is active
  logic [Settle-1:0] quiet_q;  // [k]: calm held for the last k + 1 clocks
  logic [9:0] width_q, height_q, new_width_q, new_height_q;
  logic pending_q, busy_q, apply_q, size_error_q, size_changed_q;
  logic [1:0] within_q;      // the staged width, height is in the permitted range
  logic [1:0] differs_q;     // the staged width, height differs from the active one
  logic apply, size_new;
  logic [Cameras-1:0] hold_q;  // [c]: near camera c, passed on from camera c - 1

  assign size_new = apply_q && within_q == '1 && differs_q != '0;
  assign calm     = pending_q && !active_q && !apply_q && !loading_q;
  assign apply    = calm && quiet_q[Settle-1];
  assign loading  = apply_q || (loading_q && !ended_q2);
  assign shift_g  = {begin_g_q2, shift_g_q[Coefs-1:1]};
  assign given_g  = (4 * Fours)'(given_g_q);
  assign given_g2 = (4 * Fours)'(given_g2_q);

  always_ff @(posedge clk_i) begin
    coef_q[0] <= '{valid: coef_valid_i, second: coef_second_i, index: coef_index_i, value: coef_value_i};
    for (int unsigned n = 1; n < 4; n++) coef_q[n] <= coef_q[n-1];
    for_g_q    <= coef_q[0].valid && !coef_q[0].second;
    for_g2_q   <= coef_q[1].valid && coef_q[1].second;
    stage_g_q  <= for_g_q;
    stage_g2_q <= for_g2_q;
    for (int unsigned k = 0; k < Coefs; k++) begin
      found_g_q[k]  <= for_g_q && coef_q[1].index == 5'(k);
      found_g2_q[k] <= for_g2_q && coef_q[2].index == 5'(k);
    end
    given_g_q  <= given_g_q | found_g_q;
    given_g2_q <= given_g2_q | found_g2_q;
    if (rst_i) begin
      for (int unsigned n = 0; n < 4; n++) coef_q[n].valid <= 1'b0;
      for_g_q    <= 1'b0;
      for_g2_q   <= 1'b0;
      stage_g_q  <= 1'b0;
      stage_g2_q <= 1'b0;
      found_g_q  <= '0;
      found_g2_q <= '0;
      given_g_q  <= '0;
      given_g2_q <= '0;
    end
  end

  always_ff @(posedge clk_i) begin
    if (stage_g_q) staged_g_q[coef_q[2].index] <= coef_q[2].value;
    if (stage_g2_q) staged_g2_q[coef_q[3].index] <= coef_q[3].value;
    read_g_q        <= staged_g_q[5'(place_q)];
    read_g2_q       <= staged_g2_q[5'(place_q)];
    four_q          <= place_q[PlaceW-1:2];
    for (int unsigned f = 0; f < Fours; f++) begin
      read_given_g_q[f]  <= given_g[f][place_q[1:0]];
      read_given_g2_q[f] <= given_g2[f][place_q[1:0]];
    end
    next_g_q        <= (read_given_g_q[four_q] && !clear_q) ? read_g_q : '0;
    next_g2_q       <= (read_given_g2_q[four_q] && !clear_q) ? read_g2_q : '0;
  end

  for (genvar k = 0; k < Coefs; k++) begin : g_coef
    always_ff @(posedge clk_i) begin
      if (shift_g_q[k]) g_q[k] <= (k == 0) ? next_g_q : g_q[(k==0)?0 : k-1];
      if (shift_g2_q[k]) g2_q[k] <= (k == 0) ? next_g2_q : g2_q[(k==0)?0 : k-1];
    end
  end

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      pulse_q     <= PulseW'(2 * Coefs);
      begin_g_q   <= 1'b0;
      begin_g_q2  <= 1'b0;
      begin_g2_q  <= 1'b0;
      begin_g2_q2 <= 1'b0;
      shift_g_q   <= '0;
      shift_g2_q  <= '0;
      stay_q      <= 1'b1;
      place_q     <= PlaceW'(Coefs - 1);
      end_g_q     <= 1'b0;
      end_g2_q    <= 1'b0;
      ended_q     <= 1'b0;
      ended_q2    <= 1'b0;
      loading_q   <= 1'b1;
      clear_q     <= 1'b1;
    end else begin
      if (apply_q) pulse_q <= PulseW'(2 * Coefs);
      else if (pulse_q != '0) pulse_q <= pulse_q - 1'b1;
      begin_g_q   <= pulse_q != '0 && !pulse_q[0];
      begin_g_q2  <= begin_g_q;
      begin_g2_q  <= pulse_q[0];
      begin_g2_q2 <= begin_g2_q;
      shift_g_q   <= shift_g;
      shift_g2_q  <= {begin_g2_q2, shift_g2_q[Coefs-1:1]};
      stay_q      <= !shift_g[1];
      if (!stay_q) place_q <= (place_q == '0) ? PlaceW'(Coefs - 1) : place_q - 1'b1;
      loading_q <= loading;
      end_g_q   <= !stay_q && place_q == '0;
      end_g2_q  <= end_g_q;
      ended_q   <= end_g2_q;
      ended_q2  <= ended_q;
      if (end_g_q) clear_q <= 1'b0;
    end
  end

  // The staged size one clock later (in apply_q's clock that of apply's), and whether it is permitted.
  always_ff @(posedge clk_i) begin
    new_width_q  <= width_i;
    new_height_q <= height_i;
    within_q  <= {height_i >= 10'(MinImage) && height_i <= 10'(MaxHeight),
                  width_i >= 10'(MinImage) && width_i <= 10'(MaxWidth)};
    differs_q <= {height_i != height_q, width_i != width_q};
  end

  always_ff @(posedge clk_i) begin
    if (rst_i) begin
      active_q       <= 1'b0;
      quiet_q        <= '0;
      width_q        <= 10'(MaxWidth);
      height_q       <= 10'(MaxHeight);
      pending_q      <= 1'b0;
      busy_q         <= 1'b1;
      hold_q         <= '1;
      apply_q        <= 1'b0;
      size_error_q   <= 1'b0;
      size_changed_q <= 1'b0;
    end else begin
      active_q       <= active_i != '0;
      quiet_q        <= calm ? {quiet_q[Settle-2:0], 1'b1} : '0;
      apply_q        <= apply;
      pending_q      <= commit_i || (pending_q && !apply);
      busy_q         <= commit_i || pending_q || loading;
      for (int unsigned c = 0; c < Cameras; c++) hold_q[c] <= (c == 0) ? busy_q : hold_q[(c==0)?0 : c-1];
      size_changed_q <= size_new;
      if (apply_q) size_error_q <= within_q != '1;
      if (size_new) begin
        width_q  <= new_width_q;
        height_q <= new_height_q;
      end
    end
  end

  assign hold_o         = hold_q;
  assign busy_o         = busy_q;
  assign size_error_o   = size_error_q;
  assign size_changed_o = size_changed_q;
  assign width_o        = width_q;
  assign height_o       = height_q;
  assign g_o            = g_q;
  assign g2_o           = g2_q;

  `SLOG_ASSERT_INIT(SlogFilterBankPlaces, Coefs > 1 && Coefs <= Places)
  `SLOG_ASSERT(SlogFilterBankCopies, stay_q == !shift_g_q[1])
  `SLOG_ASSERT(SlogFilterBankSize, width_o >= 10'(MinImage) && width_o <= 10'(MaxWidth)
                                   && height_o >= 10'(MinImage) && height_o <= 10'(MaxHeight))
  `SLOG_PAST(past_active, active_i)
  `SLOG_PAST(past_active2, past_active)
  `SLOG_PAST(past_active3, past_active2)
  `SLOG_ASSERT(SlogFilterBankQuiet, !size_changed_o || (past_active3 == '0 && busy_o))
  `SLOG_ASSERT(SlogFilterBankBusy, busy_o == (pending_q || apply_q || loading_q))
  `SLOG_ASSERT(SlogFilterBankLoaded, loading_q || (shift_g_q == '0 && shift_g2_q == '0 && pulse_q == '0 && !begin_g_q
                                                    && !begin_g_q2 && !begin_g2_q && !begin_g2_q2))
endmodule : slog_filter_bank
