# SPDX-License-Identifier: Apache-2.0
"""Cycle models of the wide dense engine: `slog_dense_wide_lane`, `_winner`, `_group` and `slog_dense_wide` itself."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

from golden.cycle.bits import or_zero, pack, signed
from golden.cycle.dense.memory import DenseMemoryModel
from golden.cycle.dense.structs import INDEX_BITS, SUM_BITS
from golden.cycle.model import Inputs, Values
from golden.structs import Layout

COLUMNS = 4
"""Columns of a word, and offsets of a group."""
WORD = (1 << COLUMNS) - 1
WIDE_BITS = Layout(*((name, COLUMNS) for name in ("incoming", "leaving", "incoming_ago", "leaving_ago")))
WIDE_OK = Layout(("odd", 1), ("columns", COLUMNS))
WIDE_SUMS = Layout(("last", SUM_BITS), ("less0", 8), ("less1", 8), ("less2", 7))
WIDE_SCORE = Layout(("absent", 1), ("sum", SUM_BITS))
WIDE_WINNER = Layout(("index", INDEX_BITS), ("absent", 1), ("sum", SUM_BITS))
NO_WIDE_WINNER = WIDE_WINNER.pack({"index": 0, "absent": 1, "sum": 0})
OK_LAG, OUT_LAG = 6, 10
"""Clocks by which the ok bits and the winners follow the words."""

Steps = tuple[int, ...]
"""The change e of each column of a word."""


def wide_flush_clocks(offsets: int, window: int) -> int:
    """Clocks of a flush before a pass."""
    return offsets // 2 + window // 4 + 8


def wide_latency(offsets: int) -> int:
    """Clocks from a left word to its winners."""
    return offsets // COLUMNS + OUT_LAG + 1


def changes(left: int, right: int) -> Steps:
    """e of each column of two words, packed `wide_bits_t`."""
    a = WIDE_BITS.unpack(left ^ right)
    signs = {"incoming": 1, "leaving": -1, "incoming_ago": -1, "leaving_ago": 1}
    return tuple(sum(sign * (a[name] >> j & 1) for name, sign in signs.items()) for j in range(COLUMNS))


def four_sums(sums: int) -> list[int]:
    """The sums of a packed `wide_sums_t`, modulo 2 ** SUM_BITS."""
    fields = WIDE_SUMS.unpack(sums)
    less = [signed(fields[name], bits) for name, bits in WIDE_SUMS.fields[1:]]
    return [(fields["last"] - each) % (1 << SUM_BITS) for each in (*less, 0)]


class WideLaneModel:
    """Running sums of one offset. They are undefined until delta has been cleared with known words behind it.

    Attributes:
        out: outputs of this clock, which do not depend on its inputs.
    """

    INPUTS = ("clear_i", "left_i", "right_i", "ok_i", "above_i")
    OUTPUTS = ("sums_o", "score_o")
    CLOCKS_TO_DELTA = 4

    def __init__(self) -> None:
        self.steps: deque[Steps | None] = deque([None] * (self.CLOCKS_TO_DELTA + 1))
        """Of the clocks before, the newest first."""
        self.delta: int | None = None
        self.sums: int | None = None
        self.scores: int | None = None

    @property
    def out(self) -> Values:
        return {"sums_o": self.sums, "score_o": self.scores}

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        out = self.out
        self.scores = None if self.sums is None else pack(
            [WIDE_SCORE.pack({"absent": ~i["ok_i"] >> j & 1, "sum": each}) for j, each in
             enumerate(four_sums(self.sums))], WIDE_SCORE.bits)
        self.sums = self._after(i["above_i"])
        coming = self.steps[self.CLOCKS_TO_DELTA - 1]
        if i["clear_i"]:
            self.delta = 0
        else:
            self.delta = None if coming is None or self.delta is None else self.delta + sum(coming)
        self.steps.pop()
        self.steps.appendleft(changes(i["left_i"], i["right_i"]))
        return out

    def _after(self, above: int) -> int | None:
        """The sums of the row that `above` is above of."""
        steps = self.steps[self.CLOCKS_TO_DELTA]
        if steps is None or self.delta is None:
            return None
        more = {"last": self.delta, **{f"less{j}": sum(steps[j + 1:]) for j in range(COLUMNS - 1)}}
        fields = WIDE_SUMS.unpack(above)
        return WIDE_SUMS.pack({name: fields[name] + more[name] & (1 << bits) - 1 for name, bits in WIDE_SUMS.fields})


class WideWinnerModel:
    """The best of a group's offsets and of those before it, at one column.

    Attributes:
        out: outputs of this clock, which do not depend on its inputs.
    """

    INPUTS = ("base_i", "score_i", "winner_i")
    OUTPUTS = ("winner_o",)
    CLOCKS_TO_BEST = 2

    def __init__(self) -> None:
        self.scores: deque[int | None] = deque([None] * self.CLOCKS_TO_BEST)
        self.winner: int | None = None

    @property
    def out(self) -> Values:
        return {"winner_o": self.winner}

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        out, group = self.out, self.scores.pop()
        self.scores.appendleft(i["score_i"])
        self.winner = None
        if group is not None:
            self.winner = i["winner_i"]
            scores = [group >> s * WIDE_SCORE.bits & (1 << WIDE_SCORE.bits) - 1 for s in range(COLUMNS)]
            if min(scores) < i["winner_i"] & (1 << WIDE_SCORE.bits) - 1:
                index = i["base_i"] * COLUMNS + scores.index(min(scores))
                self.winner = index << WIDE_SCORE.bits | min(scores)
        return out


class WideGroupModel:
    """Four offsets: sums, memory and winners wired together.

    Attributes:
        out: outputs of this clock, which do not depend on its inputs.
    """

    INPUTS = ("rst_i", "clear_i", "base_i", "in_row_i", "first_i", "left_i", "right_i", "left_ok_i", "right_ok_i",
              "winner_i")
    OUTPUTS = ("in_row_o", "first_o", "left_o", "right_o", "left_ok_o", "right_ok_o", "winner_o")

    def __init__(self) -> None:
        self.lanes = [WideLaneModel() for _ in range(COLUMNS)]
        self.memory = DenseMemoryModel()
        self.winners = [WideWinnerModel() for _ in range(COLUMNS)]
        # Of the clocks before, the newest first.
        self.left: deque[tuple[int, int]] = deque([(0, 0)])
        self.right: deque[tuple[int, int]] = deque([(0, 0)] * 2)
        self.row: deque[tuple[int, int]] = deque([(0, 0)] * 2)

    @property
    def out(self) -> Values:
        return {"in_row_o": self.row[0][0], "first_o": self.row[0][1], "left_o": self.left[0][0],
                "left_ok_o": self.left[0][1], "right_o": self.right[1][0], "right_ok_o": self.right[1][1],
                "winner_o": pack([winner.winner for winner in self.winners], WIDE_WINNER.bits)}

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        out, scores = self.out, [or_zero(lane.scores) for lane in self.lanes]
        above = or_zero(self.memory.out["above_o"])
        sums = or_zero(pack([or_zero(lane.sums) for lane in self.lanes], WIDE_SUMS.bits))
        self.memory.step({"rst_i": i["rst_i"] | i["clear_i"], "run_i": self.row[1][0], "first_i": self.row[1][1],
                          "sum_i": sums})
        left_ok, before = WIDE_OK.unpack(i["left_ok_i"]), self.right[0]
        near = _of_row(i["right_ok_i"], left_ok["odd"]), _of_row(before[1], left_ok["odd"])
        for s, lane in enumerate(self.lanes):
            right = {name: _shifted(now, then, s) for (name, now), then in zip(
                WIDE_BITS.unpack(i["right_i"]).items(), WIDE_BITS.unpack(before[0]).values(), strict=True)}
            lane.step({"clear_i": i["clear_i"], "left_i": i["left_i"], "right_i": WIDE_BITS.pack(right),
                       "ok_i": left_ok["columns"] & _shifted(*near, s),
                       "above_i": above >> s * WIDE_SUMS.bits & (1 << WIDE_SUMS.bits) - 1})
        for j, winner in enumerate(self.winners):
            of_column = pack([each >> j * WIDE_SCORE.bits for each in scores], WIDE_SCORE.bits)
            winner.step({"base_i": i["base_i"], "score_i": or_zero(of_column),
                         "winner_i": i["winner_i"] >> j * WIDE_WINNER.bits & (1 << WIDE_WINNER.bits) - 1})
        runs = 1 - i["clear_i"]
        self.row = deque([(i["in_row_i"] & runs, i["first_i"]), (self.row[0][0] & runs, self.row[0][1])])
        self.left = deque([(i["left_i"], i["left_ok_i"])])
        self.right = deque([(i["right_i"], i["right_ok_i"]), self.right[0]])
        return out


def _shifted(now: int, before: int, s: int) -> int:
    """Columns -s to 3 - s of a word `now`, which a word `before` precedes."""
    return (now << COLUMNS | before) >> (COLUMNS - s) & WORD


def _of_row(ok: int, odd: int) -> int:
    """The columns of a packed `wide_ok_t` if it is of an odd row, as asked for, else none."""
    fields = WIDE_OK.unpack(ok)
    return fields["columns"] if fields["odd"] == odd else 0


class DenseWideModel:
    """Groups one behind the other. The winners are defined with their valid; what is in flight in a flush is dropped.

    Args:
        offsets: a multiple of COLUMNS.
        window: side of the windows, pixels, a multiple of COLUMNS.
    """

    INPUTS = ("rst_i", "flush_i", "left_valid_i", "first_i", "left_incoming_i", "left_leaving_i", "left_ok_i",
              "left_odd_i", "right_valid_i", "right_incoming_i", "right_leaving_i", "right_ok_i", "right_odd_i")
    OUTPUTS = ("winner_valid_o", "winner_o")

    def __init__(self, offsets: int, window: int) -> None:
        self.groups = [WideGroupModel() for _ in range(offsets // COLUMNS)]
        self.planes: deque[tuple[int, int]] = deque([(0, 0)] * (window // COLUMNS + 1))
        """(left, right) words of the clocks before, the newest first: incoming, leaving."""
        self.oks: deque[tuple[int, int]] = deque([(0, 0)] * (OK_LAG + 1))
        self.flushes = [0] * len(self.groups)
        self.valid: deque[int] = deque([0] * OUT_LAG)
        self.winner: int | None = None
        self.in_row = self.first = self.flush = 0
        """Of the clock before."""

    def step(self, i: Inputs) -> Values:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        valid, found = self.valid[-1], self.groups[-1].out
        out: Values = {"winner_valid_o": valid, "winner_o": self.winner if valid else None}
        ended, winners = self.flushes[-1], found["winner_o"]
        self.winner = None if winners is None else pack(_known(winners), WIDE_WINNER.bits)
        self._move(i["rst_i"])
        self.valid.pop()
        self.valid.appendleft(or_zero(found["in_row_o"]))
        if i["rst_i"] or ended:
            self.valid = deque([0] * OUT_LAG)
        left, right = (WORD * i[f"{side}_valid_i"] for side in ("left", "right"))
        self.planes.pop()
        self.planes.appendleft(((left & i["left_incoming_i"]) << COLUMNS | left & i["left_leaving_i"],
                                (right & i["right_incoming_i"]) << COLUMNS | right & i["right_leaving_i"]))
        self.oks.pop()
        self.oks.appendleft((WIDE_OK.pack({"odd": i["left_odd_i"], "columns": left & i["left_ok_i"]}),
                             WIDE_OK.pack({"odd": i["right_odd_i"], "columns": right & i["right_ok_i"]})))
        self.flushes = [self.flush, *self.flushes[:-1]]
        self.in_row, self.first, self.flush = i["left_valid_i"], i["first_i"], i["flush_i"]
        if i["rst_i"]:
            self.flushes, self.flush, self.in_row = [1] * len(self.groups), 1, 0
        return out

    def _move(self, rst: int) -> None:
        """A clock of the groups."""
        bits = [now << 2 * COLUMNS | then for now, then in zip(self.planes[0], self.planes[-1], strict=True)]
        coming: Values = {"in_row_o": self.in_row, "first_o": self.first, "left_o": bits[0], "right_o": bits[1],
                          "left_ok_o": self.oks[-1][0], "right_ok_o": self.oks[-1][1],
                          "winner_o": pack([NO_WIDE_WINNER] * COLUMNS, WIDE_WINNER.bits)}
        for g, (group, flush) in enumerate(zip(self.groups, self.flushes, strict=True)):
            handed = {f"{name[:-2]}_i": or_zero(value) for name, value in coming.items()}
            coming = group.step({**handed, "rst_i": rst, "clear_i": flush, "base_i": g})


def _known(winners: int) -> Sequence[int]:
    """The winners of a word, NO_WIDE_WINNER where no offset counts."""
    found = [winners >> j * WIDE_WINNER.bits & (1 << WIDE_WINNER.bits) - 1 for j in range(COLUMNS)]
    return [NO_WIDE_WINNER if WIDE_WINNER.unpack(each)["absent"] else each for each in found]
