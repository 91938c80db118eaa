// Unrolls a job's context into its rows of offsets. A refused job gives one row.
//
// Latency    : a context taken in clock t offers its first row in clock t+1.
// Throughput : one row per clock, jobs back to back.
module slog_peak_rows
  import slog_pkg::*;
  import slog_peak_pkg::*;
(
    input  logic     clk_i,
    input  logic     rst_i,
    input  logic     ctx_valid_i,
    output logic     ctx_ready_o,
    input  context_t ctx_i,
    output logic     row_valid_o,
    input  logic     row_ready_i,
    output row_t     row_o,
    output scoring_t scoring_o
);
  logic valid_q, load;
  row_t row_q;
  scoring_t scoring_q;
  logic [9:0] left_q;  // rows after this one

  assign load        = !valid_q || (row_ready_i && row_q.last);
  assign ctx_ready_o = load;
  assign row_valid_o = valid_q;
  assign row_o       = row_q;
  assign scoring_o   = scoring_q;

  always_ff @(posedge clk_i) begin
    if (rst_i) valid_q <= 1'b0;
    else if (load) valid_q <= ctx_valid_i;
  end

  always_ff @(posedge clk_i) begin
    if (load) begin
      row_q.tag    <= ctx_i.tag;
      row_q.status <= ctx_i.status;
      row_q.last_x <= ctx_i.offsets_x - 10'd1;
      row_q.y      <= '0;
      row_q.first  <= 1'b1;
      row_q.last   <= ctx_i.status != StatusOk || ctx_i.offsets_y == 10'd1;
      left_q       <= ctx_i.offsets_y - 10'd1;
      scoring_q    <= '{surface: ctx_i.surface, area: ctx_i.area};
    end else if (row_ready_i) begin
      row_q.y     <= row_q.y + 10'd1;
      row_q.first <= 1'b0;
      row_q.last  <= left_q == 10'd1;
      left_q      <= left_q - 10'd1;
    end
  end
endmodule : slog_peak_rows
