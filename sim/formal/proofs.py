# SPDX-License-Identifier: Apache-2.0
"""The proofs: what is proved of which module, and why the other modules with control have none."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

Mode = Literal["prove", "bmc", "cover"]


@dataclass(frozen=True)
class Proof:
    """One run of the prover on one module with given parameters.

    Attributes:
        name: of the proof, unique.
        top: the module, with every module that it uses.
        mode: `prove` is k-induction: the assertions hold for ever. `bmc` examines only the first `depth` clocks after
            power-up. `cover` shows that every cover point can be reached in `depth` clocks.
        depth: clocks; of `prove`, the length of the induction.
        parameters: of `top`.
        rules: files of `properties/` bound to the design, besides the reset's.
        assumed: assertions of `top` about its user, which are assumed instead of proved. They are proved, or tested in
            simulation, where the module is used.
        reset: clocks for which the reset is held, at power-up and later; 0: the module has no reset.
        quick: part of the quick selection.
        engine: of SymbiYosys.
        config: configuration whose package is read.
        blackboxes: modules whose outputs may be anything.
        removed: assertions that another proof holds, of the same module or of one within it, or that say something of
            the modules left out.
    """

    name: str
    top: str
    mode: Mode
    depth: int
    parameters: Mapping[str, int] = field(default_factory=dict)
    rules: tuple[str, ...] = ()
    assumed: tuple[str, ...] = ()
    reset: int = 1
    quick: bool = True
    engine: str = "smtbmc yices"
    config: str = "tiny"
    blackboxes: tuple[str, ...] = ()
    removed: tuple[str, ...] = ()


CONTROL_PARTS = ("slog_filter_bank", "slog_peek", "slog_counters")
BOARD_PARTS = ("slog_control", "slog_frontend", "slog_capture", "slog_store", "slog_correlator")
OPERANDS_USER = ("SlogOperandsStep", "SlogOperandsWrite", "SlogOperandsTplReuse", "*SlogSearchRingSameClock")
PARTS_OWN = ("*.Slog*",)
"""Assertions of the modules within the top one, which their own proofs hold."""

PROOFS: tuple[Proof, ...] = (
    Proof("fifo", "slog_fifo", "prove", 3, {"Width": 2, "Depth": 4}, rules=("fifo",)),
    Proof("fifo_odd", "slog_fifo", "prove", 3, {"Width": 2, "Depth": 3}, rules=("fifo",)),
    Proof("fifo_one", "slog_fifo", "prove", 3, {"Width": 2, "Depth": 1}, rules=("fifo",)),
    Proof("fifo_kept", "slog_fifo", "prove", 3, {"Width": 2, "Depth": 4, "Kept": 1}, rules=("fifo",),
          assumed=("SlogFifoKept",)),
    Proof("fifo_covers", "slog_fifo", "cover", 12, {"Width": 2, "Depth": 4}, rules=("fifo",)),
    Proof("stage", "slog_stage", "prove", 3, {"Width": 2}, rules=("stage",)),
    Proof("stage_half", "slog_stage", "prove", 3, {"Width": 2, "Half": 1}, rules=("stage",)),
    Proof("ram_fifo", "slog_ram_fifo", "prove", 6, {"Width": 2, "Depth": 4}, rules=("fifo", "ram_fifo")),
    Proof("peak_room", "slog_peak_room", "prove", 5, {"Depth": 20, "MaxOffsets": 12}, rules=("peak_room",),
          assumed=("SlogPeakRoomOffsets",)),
    Proof("peak_room_full", "slog_peak_room", "prove", 5, {"Depth": 1024, "MaxOffsets": 640}, rules=("peak_room",),
          assumed=("SlogPeakRoomOffsets",)),
    Proof("peak_room_covers", "slog_peak_room", "cover", 24, {"Depth": 20, "MaxOffsets": 12}, rules=("peak_room",),
          assumed=("SlogPeakRoomOffsets",)),
    Proof("job_check", "slog_job_check", "prove", 13, rules=("job_check",),
          assumed=("SlogJobCheckOneAtATime", "SlogJobCheckStable")),
    Proof("job_check_covers", "slog_job_check", "cover", 12, rules=("job_check",),
          assumed=("SlogJobCheckOneAtATime", "SlogJobCheckStable")),
    Proof("job_plan", "slog_job_plan", "bmc", 11, {"Width": 8, "MaxHeight": 36, "WordsPerRow": 6}, rules=("job_plan",),
          assumed=("SlogJobPlanStable", "SlogJobPlanOneAtATime")),
    Proof("job_plan_covers", "slog_job_plan", "cover", 12, {"Width": 8, "MaxHeight": 36, "WordsPerRow": 6},
          rules=("job_plan",),
          assumed=("SlogJobPlanStable", "SlogJobPlanOneAtATime")),
    Proof("grid", "slog_grid", "prove", 3, rules=("grid",), assumed=("SlogGridReadyStays",)),
    Proof("grid_covers", "slog_grid", "cover", 20, rules=("grid",), assumed=("SlogGridReadyStays",), quick=False),
    Proof("packer", "slog_packer", "prove", 10, {"GroupBits": 4}, rules=("packer",), assumed=("SlogPackerAbortAlone",)),
    Proof("packer_slices", "slog_packer", "prove", 10, {"GroupBits": 32}, rules=("packer",),
          assumed=("SlogPackerAbortAlone",)),
    Proof("packer_covers", "slog_packer", "cover", 18, {"GroupBits": 4}, rules=("packer",),
          assumed=("SlogPackerAbortAlone",)),
    Proof("axil", "slog_axil", "prove", 4, {"AddrW": 5}, rules=("axil",)),
    Proof("axil_covers", "slog_axil", "cover", 22, {"AddrW": 5}, rules=("axil",)),
    Proof("running_max", "slog_running_max", "prove", 4, rules=("running_max",), assumed=("SlogRunningMaxIndices",)),
    Proof("running_max_covers", "slog_running_max", "cover", 12, {"ValueW": 3, "IndexW": 3}, rules=("running_max",),
          assumed=("SlogRunningMaxIndices",)),
    Proof("walker", "slog_walker", "prove", 4, {"Pitch": 4, "RingRows": 32, "DrainClocks": 4}, rules=("walker",),
          assumed=("SlogWalkerRowStable", "SlogWalkerLanes")),
    Proof("walker_full", "slog_walker", "prove", 4, {"Pitch": 32, "RingRows": 256, "DrainClocks": 45},
          rules=("walker",), assumed=("SlogWalkerRowStable", "SlogWalkerLanes")),
    Proof("walker_covers", "slog_walker", "cover", 20, {"Pitch": 4, "RingRows": 32, "DrainClocks": 4},
          rules=("walker",), assumed=("SlogWalkerRowStable", "SlogWalkerLanes")),
    Proof("sequencer", "slog_sequencer", "prove", 14, {"GroupBits": 8, "Pitch": 4, "RingRows": 32, "DrainClocks": 4},
          rules=("sequencer",), assumed=("SlogSequencerFreed",)),
    Proof("sequencer_covers", "slog_sequencer", "cover", 24, {"GroupBits": 8, "Pitch": 4, "RingRows": 32,
          "DrainClocks": 4},
          rules=("sequencer",), assumed=("SlogSequencerFreed",)),
    Proof("popcount", "slog_popcount", "bmc", 8, {"GroupBits": 4, "Lanes": 1}, rules=("popcount",), reset=0),
    Proof("popcount_covers", "slog_popcount", "cover", 10, {"GroupBits": 4, "Lanes": 1}, rules=("popcount",), reset=0),
    Proof("video_in", "slog_video_in", "prove", 10, {"MaxWidth": 8, "Radius": 2}, rules=("video_in",),
          assumed=("SlogVideoInSize",)),
    Proof("video_in_covers", "slog_video_in", "cover", 28, {"MaxWidth": 8, "Radius": 2}, rules=("video_in",),
          assumed=("SlogVideoInSize",)),
    Proof("peak_rows", "slog_peak_rows", "prove", 4, rules=("peak_rows",)),
    Proof("peak_rows_covers", "slog_peak_rows", "cover", 14, rules=("peak_rows",), quick=False),
    Proof("peak_scan", "slog_peak_scan", "bmc", 18, rules=("peak_scan",), assumed=("SlogPeakScanRoom",
          "SlogPeakScanOrder", "SlogPeakScanBest"), quick=False),
    Proof("peak_scan_covers", "slog_peak_scan", "cover", 24, rules=("peak_scan",), assumed=("SlogPeakScanRoom",
          "SlogPeakScanOrder", "SlogPeakScanBest"), quick=False),
    Proof("peak_best", "slog_peak_best", "prove", 12, assumed=("SlogPeakBestRowStable",)),
    Proof("filter_bank", "slog_filter_bank", "bmc", 56, {"Coefs": 2, "CoefBits": 2, "MinImage": 18, "MaxWidth": 48,
          "MaxHeight": 36}, rules=("filter_bank",), quick=False),
    Proof("filter_bank_covers", "slog_filter_bank", "cover", 56, {"Coefs": 2, "CoefBits": 2, "MinImage": 18,
          "MaxWidth": 48, "MaxHeight": 36}, rules=("filter_bank",), quick=False),
    Proof("filter_bank_reset", "slog_filter_bank", "bmc", 10, {"Coefs": 3, "MinImage": 18, "MaxWidth": 48,
          "MaxHeight": 36}),
    Proof("store", "slog_store", "prove", 16, {"Width": 1, "Words": 7, "BankWords": 4}, rules=("store",),
          assumed=("SlogStoreAddress", "SlogStoreWriteAddress", "SlogStorePeekAddress", "SlogStoreReadNotWrite")),
    Proof("store_covers", "slog_store", "cover", 28, {"Width": 1, "Words": 7, "BankWords": 4}, rules=("store",),
          assumed=("SlogStoreAddress", "SlogStoreWriteAddress", "SlogStorePeekAddress", "SlogStoreReadNotWrite"),
          quick=False),
    Proof("accumulator", "slog_accumulator", "prove", 14, {"CountBits": 2, "ScoreBits": 4, "Lanes": 2},
          rules=("accumulator",), reset=0),
    Proof("accumulator_covers", "slog_accumulator", "cover", 16, {"CountBits": 2, "ScoreBits": 4, "Lanes": 2},
          rules=("accumulator",), reset=0, quick=False),
    Proof("emit", "slog_emit", "prove", 26, {"ScoreBits": 3, "Lanes": 5}, rules=("emit",),
          assumed=("SlogEmitOnePass", "SlogEmitLanes"), removed=("SlogEmitZero",), quick=False),
    Proof("emit_zero", "slog_emit", "prove", 4, {"ScoreBits": 3, "Lanes": 5}, rules=("emit_zero",),
          assumed=("SlogEmitOnePass", "SlogEmitLanes")),
    Proof("emit_covers", "slog_emit", "cover", 34, {"ScoreBits": 3, "Lanes": 5}, rules=("emit",),
          assumed=("SlogEmitOnePass", "SlogEmitLanes"), quick=False),
    Proof("peek", "slog_peek", "prove", 8, {"GroupBits": 8, "StoreWords": 3}, rules=("peek",),
          assumed=("SlogPeekAddressStays",)),
    Proof("peek_wide", "slog_peek", "prove", 8, {"GroupBits": 64, "StoreWords": 3}, rules=("peek",),
          assumed=("SlogPeekAddressStays",), quick=False),
    Proof("peek_covers", "slog_peek", "cover", 40, {"GroupBits": 64, "StoreWords": 3}, rules=("peek",),
          assumed=("SlogPeekAddressStays",)),
    Proof("capture_words", "slog_capture", "prove", 4, {"GroupBits": 2, "Slots": 2, "SlotWords": 4, "WordsPerRow": 2},
          rules=("capture_words",), blackboxes=("slog_capture_channel",), quick=False),
    Proof("capture_words_covers", "slog_capture", "cover", 20, {"GroupBits": 2, "Slots": 2, "SlotWords": 4,
          "WordsPerRow": 2}, rules=("capture_words",), blackboxes=("slog_capture_channel",), quick=False),
    Proof("peak_intake", "slog_peak_intake", "prove", 4, {"ScoreBits": 9}, rules=("peak_intake",),
          assumed=("SlogPeakIntakeArea", "SlogPeakIntakeRowStays")),
    Proof("peak_intake_covers", "slog_peak_intake", "cover", 16, {"ScoreBits": 9}, rules=("peak_intake",),
          assumed=("SlogPeakIntakeArea", "SlogPeakIntakeRowStays"), quick=False),
    Proof("capture_slots", "slog_capture", "bmc", 38, {"GroupBits": 2, "Slots": 2, "SlotWords": 4, "WordsPerRow": 2},
          rules=("capture_slots",), assumed=("*SlogCaptureRoom", "*SlogCaptureNoEarlyWord"), quick=False),
    Proof("capture_slots_covers", "slog_capture", "cover", 34, {"GroupBits": 2, "Slots": 2, "SlotWords": 4,
          "WordsPerRow": 2}, rules=("capture_slots",),
          assumed=("*SlogCaptureRoom", "*SlogCaptureNoEarlyWord"), quick=False),
    Proof("fetch", "slog_fetch", "bmc", 40, {"Width": 4, "MaxHeight": 8, "WordsPerRow": 2, "Slots": 2, "MinWindow": 1,
          "MaxWindow": 4, "RingRows": 4}, rules=("fetch",), blackboxes=("slog_job_check", "slog_job_plan"),
          quick=False),
    Proof("fetch_covers", "slog_fetch", "cover", 60, {"Width": 4, "MaxHeight": 8, "WordsPerRow": 2, "Slots": 2,
          "MinWindow": 1, "MaxWindow": 4, "RingRows": 4}, rules=("fetch",),
          blackboxes=("slog_job_check", "slog_job_plan"), quick=False),
    Proof("operands", "slog_operands", "prove", 14, {"GroupBits": 4, "Lanes": 3, "RingRows": 4, "WordsPerRow": 8},
          rules=("operands",), assumed=OPERANDS_USER),
    Proof("operands_covers", "slog_operands", "cover", 24, {"GroupBits": 4, "Lanes": 3, "RingRows": 4,
          "WordsPerRow": 8}, rules=("operands",), assumed=OPERANDS_USER, quick=False),
    Proof("peak_row", "slog_peak", "bmc", 48, {"ScoreBits": 2, "MaxOffsets": 3, "ScoreDepth": 3, "ResultDepth": 2},
          rules=("peak",), removed=PARTS_OWN, quick=False),
    Proof("peak_rows_of_two", "slog_peak", "bmc", 54, {"ScoreBits": 2, "MaxOffsets": 2, "ScoreDepth": 6,
          "ResultDepth": 2}, rules=("peak",), removed=("*Slog*",), quick=False),
    Proof("peak_covers", "slog_peak", "cover", 56, {"ScoreBits": 2, "MaxOffsets": 3, "ScoreDepth": 3,
          "ResultDepth": 2}, rules=("peak",), removed=("*Slog*",), quick=False),
    Proof("control", "slog_control", "prove", 16, rules=("control",), blackboxes=CONTROL_PARTS),
    Proof("control_covers", "slog_control", "cover", 32, rules=("control",), blackboxes=CONTROL_PARTS, quick=False),
    Proof("board_busy", "slog_board", "prove", 14, rules=("fifo", "ram_fifo", "board"), blackboxes=BOARD_PARTS,
          removed=("SlogBoardOneFrame",), quick=False),
    Proof("board_busy_covers", "slog_board", "cover", 24, rules=("board",), blackboxes=BOARD_PARTS,
          removed=("SlogBoardOneFrame",), quick=False),
    Proof("reset", "slog_reset", "prove", 12, rules=("board_reset",), reset=0),
    Proof("reset_covers", "slog_reset", "cover", 20, rules=("board_reset",), reset=0),
    Proof("dense_lanes_3", "slog_dense_lanes", "prove", 22, {"Lanes": 2, "MaxWindow": 3}, rules=("dense_lanes",),
          reset=0),
    Proof("dense_lanes_4", "slog_dense_lanes", "prove", 24, {"Lanes": 2, "MaxWindow": 4}, rules=("dense_lanes",),
          reset=0, quick=False),
    Proof("dense_lanes_covers", "slog_dense_lanes", "cover", 30, {"Lanes": 2, "MaxWindow": 3}, rules=("dense_lanes",),
          reset=0),
    Proof("dense_room", "slog_dense_room", "prove", 4, {"Depth": 20}, rules=("dense_room",),
          assumed=("SlogDenseRoomReserve", "SlogDenseRoomTaken", "SlogDenseRoomWords")),
    Proof("dense_room_covers", "slog_dense_room", "cover", 20, {"Depth": 20}, rules=("dense_room",),
          assumed=("SlogDenseRoomReserve", "SlogDenseRoomTaken", "SlogDenseRoomWords")),
    Proof("dense_pass", "slog_dense_pass", "prove", 10, {"Flush": 6}, rules=("dense_pass",)),
    Proof("dense_pass_covers", "slog_dense_pass", "cover", 40, {"Flush": 6}, rules=("dense_pass",), quick=False),
    Proof("dense_live", "slog_dense_live", "bmc", 20, rules=("dense_live",), assumed=("*SlogDenseLiveRows",)),
    Proof("dense_live_covers", "slog_dense_live", "cover", 24, rules=("dense_live",), assumed=("*SlogDenseLiveRows",),
          quick=False),
    Proof("capture_channel", "slog_capture_channel", "prove", 6,
          {"GroupBits": 2, "Slots": 2, "SlotWords": 4, "WordsPerRow": 2, "Progress": 1},
          assumed=("SlogCaptureRoom", "SlogCaptureWaits", "SlogCaptureArmWhenFree", "SlogCaptureNoEarlyWord")),
)


DATA = "data path without decisions of its own; cocotb compares every output with the golden model on every clock"
WIRES = "instances and wires, with pipeline registers at most; its parts are proved or have their reason here"
LARGE = "too large for the solver with its memories and multipliers; lockstep with the golden board is the evidence"

REASONS: Mapping[str, str] = {
    "slog_add_halves": "part of the proof `popcount`",
    "slog_align": DATA,
    "slog_array": WIRES,
    "slog_capture_slice": "part of the proof `capture_words`",
    "slog_clock_gate": "only in the fast simulation build, whose outputs are compared with the golden board's",
    "slog_correlator": WIRES,
    "slog_counters": DATA,
    "slog_dense": WIRES,
    "slog_dense_back": DATA,
    "slog_dense_board": WIRES,
    "slog_dense_check": DATA,
    "slog_dense_control": "generated registers and pulses of a clock; cocotb writes and reads every one of them",
    "slog_dense_engine": WIRES,
    "slog_dense_feed": "that each word comes in time and none is lost is asserted in its streams, at every offset of "
                       "the planes; cocotb compares every clock",
    "slog_dense_group": WIRES,
    "slog_dense_memory": DATA,
    "slog_dense_out": "counters of pixels before a queue that is proved; cocotb compares every clock",
    "slog_dense_plan": "sums of a job's numbers, once a pass; cocotb compares every clock over jobs of every kind",
    "slog_dense_stream": "see `slog_dense_feed`",
    "slog_dense_wide": WIRES,
    "slog_dense_wide_group": WIRES,
    "slog_dense_wide_lane": "counting four windows at once is too much for the solver; `dense_lanes_4` proves the "
                            "same recurrence for the engine of one pixel a clock, whole maps are compared with the "
                            "frame level",
    "slog_dense_wide_winner": DATA,
    "slog_dense_winner": DATA,
    "slog_fir": DATA,
    "slog_fir_kernel": DATA,
    "slog_fir_tree": DATA,
    "slog_frontend": LARGE,
    "slog_lanes": DATA,
    "slog_line_bank": DATA,
    "slog_line_buffer": LARGE,
    "slog_log": LARGE,
    "slog_mult": "the operator * behind registers",
    "slog_packer_slice": "part of the proof `packer`",
    "slog_peak_collect": "part of the proofs `peak_row` and `peak_rows_of_two`",
    "slog_ram": "part of the proofs `ram_fifo` and `store`",
    "slog_ram_clear": "a memory behind registers; cocotb compares it and its twin with the golden model on every clock",
    "slog_reset_buffer": "a wire",
    "slog_ring_slice": "part of the proof `operands`",
    "slog_search_ring": "part of the proof `operands`",
    "slog_store_slice": "part of the proof `store`",
    "slog_taps": DATA,
    "slog_taps_slice": DATA,
    "slog_taps_window": DATA,
}
"""Modules without a proof, and why."""
