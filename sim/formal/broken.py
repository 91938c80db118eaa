# SPDX-License-Identifier: Apache-2.0
"""One defect for each proof, which the proof must find: `python -m sim.formal --broken` plants them one by one.

A proof that does not fail on its defect proves too little, and fails this check.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from sim.formal.proofs import Proof
from sim.toolchain import RTL, sources_of


@dataclass(frozen=True)
class Defect:
    """A change of the RTL: `old`, which occurs once in `file` (within `rtl/`), becomes `new`."""

    file: str
    old: str
    new: str


DEFECTS: dict[str, Defect] = {
    "fifo": Defect("cells/slog_fifo.sv", "if (push) mem_q", "if (push && !pop) mem_q"),
    "fifo_odd": Defect("cells/slog_fifo.sv", "(place == Last) ? '0 : place + 1'b1", "place + 1'b1"),
    "fifo_one": Defect("cells/slog_fifo.sv", "out_valid_o = !held_q[0];", "out_valid_o = !held_q[0] || in_valid_i;"),
    "fifo_kept": Defect("cells/slog_fifo.sv", "= push && !pop;", "= push;"),
    "stage": Defect("cells/slog_stage.sv", "if (free_q || (out_ready_i && !Half)) data_q", "if (free_q) data_q"),
    "stage_half": Defect("cells/slog_stage.sv", "valid_q && !out_ready_i;", "valid_q;"),
    "ram_fifo": Defect("cells/slog_ram_fifo.sv", "(read_q ? others_q : some_q)", "some_q"),
    "peak_room": Defect("peak/slog_peak_room.sv", "2'(taken_i) + 2'(grant && taken_q)", "2'(taken_i) + 2'(taken_q)"),
    "peak_room_full": Defect("peak/slog_peak_room.sv", "!grant && held_q <=", "held_q <="),
    "job_check": Defect("correlator/slog_job_check.sv", "bottom_q    <= 12'(job_i.search_y) + 12'(span_y_q);",
                        "bottom_q    <= 12'(11'(11'(job_i.search_y) + span_y_q));"),
    "job_plan": Defect("correlator/slog_job_plan.sv", "search_last_q <= word_of(job_q.search_x + span_q);",
                       "search_last_q <= word_of(job_q.search_x) + word_of(span_q);"),
    "grid": Defect("correlator/slog_grid.sv", "return position[9:0] | {10{position[10]}};", "return position[9:0];"),
    "packer": Defect("frontend/slog_packer.sv", "anew_q   <= abort_q[0];", "anew_q   <= 1'b0;"),
    "packer_slices": Defect("frontend/slog_packer.sv", "place_q == PlaceW'(SliceBits * s - 1)",
                            "place_q == PlaceW'(SliceBits * s)"),
    "control": Defect("control/slog_axil.sv", "!(ar_waits_q && wait_i) && !under_way_q;", "!(ar_waits_q && wait_i);"),
    "board_busy": Defect("correlator/slog_grid.sv", "<= !taken_q && (!ready_q || job_valid_i) && job_ready_i;",
                         "<= !taken_q && !ready_q && job_ready_i;"),
    "capture_slots": Defect("store/slog_capture_channel.sv", "CheckClocks = 3'd5", "CheckClocks = 3'd4"),
    "fetch": Defect("correlator/slog_fetch.sv", "? next_line_q + AddrW'(WordsPerRow) :",
                    "? next_line_q + AddrW'(WordsPerRow + 1) :"),
    "operands": Defect("array/slog_search_ring.sv", "row_i[RowW-1:1] + (RowW - 1)'(row_i[0])", "row_i[RowW-1:1]"),
    "dense_lanes_3": Defect("dense/slog_dense_lanes.sv", "3'(x_q[k].leaving_ago) - 3'(x_q[k].leaving)",
                            "3'(x_q[k].leaving_ago) - 3'(x_q[k].incoming)"),
    "dense_lanes_4": Defect("dense/slog_dense_lanes.sv", "(left_ok[k] & right_ok[k]) != '0",
                            "left_ok[k] != '0 && right_ok[k] != '0"),
    "dense_room": Defect("dense/slog_dense_room.sv", "free_q >= FreeW'(words_i);", "free_q != '0;"),
    "dense_pass": Defect("dense/slog_dense_pass.sv", "(go && has_q)", "(ready && has_q)"),
    "dense_live": Defect("dense/slog_dense_live.sv", "is_above(32'(rows_q[0]), 32'(y_q))", "rows_q[0] >= y_q"),
    "axil": Defect("control/slog_axil.sv", "can_write = aw_q2 && w_q2", "can_write = aw_q2"),
    "running_max": Defect("peak/slog_running_max.sv", "32'({max_q[1], index_q[0]}), 32'({max_q[0], index_q[1]})",
                          "32'({max_q[1], index_q[1]}), 32'({max_q[0], index_q[0]})"),
    "walker": Defect("correlator/slog_walker.sv", "row_q.wide || more_q || !row_q.odd", "row_q.wide || more_q"),
    "walker_full": Defect("correlator/slog_walker.sv", "again_q ? 6'(Pitch) : row_q.last_lanes", "row_q.last_lanes"),
    "sequencer": Defect("correlator/slog_sequencer.sv", "= rows_written_i - need_q;",
                        "= rows_written_i - need_q + 1'b1;"),
    "popcount": Defect("array/slog_popcount.sv", "assign extra_o = g_late[Levels].rest;",
                       "assign extra_o = g_late[Levels].enter;"),
    "video_in": Defect("frontend/slog_video_in.sv", " || (drop && drop_owed_q);", ";"),
    "peak_row": Defect("peak/slog_peak_collect.sv", "s2_above_far_q ? s2_outcome_q.other : s2_far_q;",
                       "s2_outcome_q.other;"),
    "peak_rows_of_two": Defect("peak/slog_peak_collect.sv", "else if (s2_above_held_q) runner_up_q",
                               "else if (1'b0) runner_up_q"),
    "peak_rows": Defect("peak/slog_peak_rows.sv", "row_q.last <= left_q == 10'd1;", "row_q.last <= left_q == 10'd2;"),
    "peak_scan": Defect("peak/slog_peak_scan.sv", "west: until_q == 11'd1", "west: until_q[0]"),
    "peak_best": Defect("peak/slog_peak_best.sv", "order_room_i && (room_i || more_q);", "order_room_i;"),
    "filter_bank": Defect("control/slog_filter_bank.sv", "quiet_q        <= calm ? {quiet_q[Settle-2:0], 1'b1} : '0;",
                          "quiet_q        <= {quiet_q[Settle-2:0], calm};"),
    "filter_bank_reset": Defect("control/slog_filter_bank.sv", "busy_q         <= 1'b1;", "busy_q         <= 1'b0;"),
    "store": Defect("store/slog_store_slice.sv", "if (rd_en_q6[b]) chosen", "if (rd_en_q5[b]) chosen"),
    "accumulator": Defect("array/slog_accumulator.sv", "extra_q[k]});", "1'b0});"),
    "emit": Defect("array/slog_emit.sv", "last_i ? lanes_i != LaneW'(1) :", "last_i ? lanes_i != '0 :"),
    "emit_zero": Defect("array/slog_emit.sv", "token_q[k-1][0] & more_q[k/Reach]", "token_q[k-1][0]"),
    "peek": Defect("control/slog_peek.sv", "(flight_q && !done_q) || taken;", "(flight_q && !done_q);"),
    "peek_wide": Defect("control/slog_peek.sv", "if (onward_q || go_q) chunk_q", "if (onward_q) chunk_q"),
    "capture_words": Defect("store/slog_capture_slice.sv", "(c == 0 || empty_q[0]);", "1'b1;"),
    "peak_intake": Defect("peak/slog_peak_intake.sv", "s1_last_q     <= end_q;", "s1_last_q     <= near_q;"),
    "reset": Defect("cells/slog_reset.sv", "rst_q2 || past_q != '0;", "rst_q2 || past_q[0];"),
    "capture_channel": Defect("store/slog_capture_channel.sv", "finishing_q   <= !cancel_i && (", "finishing_q   <= ("),
}
"""By name of the proof; proofs of the kind `cover` have none: they fail where a point is not reached."""


def broken_sources(proof: Proof, folder: Path) -> list[Path]:
    """The sources of `proof` with its defect, whose file is written into `folder`.

    Raises:
        SystemExit: if the place of the defect is not found exactly once.
    """
    defect = DEFECTS[proof.name]
    path = RTL / defect.file
    text = path.read_text()
    if text.count(defect.old) != 1:
        raise SystemExit(f"the defect of the proof {proof.name}: {defect.old!r} occurs {text.count(defect.old)} times "
                         f"in {path}; choose another place in sim/formal/broken.py")
    folder.mkdir(parents=True, exist_ok=True)
    broken = folder / path.name
    broken.write_text(text.replace(defect.old, defect.new))
    return [broken if source == path else source for source in sources_of(proof.top, proof.config)]
