"""Cycle models of the parts of `slog_peak`. Structs are those of rtl/slog_peak_pkg.sv, packed into integers.

Scores that may be absent are {present, score}: `PRESENT + score`, or 0. Data outputs are undefined (None) while their
valid is low.
"""

from __future__ import annotations

from collections import deque

from golden.correlate import Status
from golden.params import NO_SCORE, SCORE_BITS
from golden.structs import CONTEXT, Layout

PRESENT = 1 << SCORE_BITS
ROW = Layout(("tag", 16), ("status", 3), ("last_x", 10), ("y", 10), ("first", 1), ("last", 1))
SCORING = Layout(("surface", 1), ("one", 1), ("two", 1), ("area", 15))
SCAN = Layout(("fresh", 1), ("last", 1), ("above", 1), ("middle", 1), ("below", 1), ("only", 1), ("brief", 1),
              ("last_x", 10), ("best_x", 10))
OUTCOME = Layout(("fresh", 1), ("last", 1), ("other", 16), ("tag", 16), ("status", 3), ("best_x", 10), ("best_y", 10),
                 ("score", 16))
VERDICT = Layout(("tag", 16), ("status", 3), ("best_x", 10), ("best_y", 10), ("score", 15), ("runner_up", 15))

Inputs = dict[str, int]
Outputs = dict[str, int | None]


def or_no_score(value: int) -> int:
    """A score that may be absent, as results carry it."""
    return value - PRESENT if value else NO_SCORE


class RoomModel:
    """`slog_peak_room`: scores granted and not gone. A departure counts one clock late, two beside a grant."""

    INPUTS = ("rst_i", "row_valid_i", "row_offsets_i", "taken_i")
    OUTPUTS = ("row_ready_o",)

    def __init__(self, depth: int, max_offsets: int) -> None:
        self.limit = depth - max_offsets
        self.clear()

    def clear(self) -> None:
        """Nothing granted; no row is granted in the clock after."""
        self.held, self.late, self.ready = 0, 0, 0

    def step(self, i: Inputs) -> Outputs:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        ready = self.ready
        if i["rst_i"]:
            self.clear()
        elif i["row_valid_i"] and ready:
            self.ready = 0
            self.held += i["row_offsets_i"]
            self.late += i["taken_i"]
        else:
            self.ready = int(self.held <= self.limit)
            self.held -= self.late
            self.late = i["taken_i"]
        return {"row_ready_o": ready}


class RowsModel:
    """`slog_peak_rows`: the rows of a job, one after another. A row stays for one clock after it was taken."""

    INPUTS = ("rst_i", "ctx_valid_i", "ctx_i", "row_taken_i")
    OUTPUTS = ("ctx_ready_o", "row_coming_o", "row_o", "scoring_o")

    def __init__(self) -> None:
        self.rows: deque[int] = deque()
        self.scoring: int | None = None
        self.taken = 0
        """The row in front was taken in the clock before."""

    def step(self, i: Inputs) -> Outputs:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        rows = self.rows
        load = len(rows) == self.taken
        out: Outputs = {"ctx_ready_o": int(load), "row_o": rows[0] if rows else None,
                        "scoring_o": self.scoring if rows else None,
                        "row_coming_o": None if i["row_taken_i"] else int(not load or i["ctx_valid_i"])}
        if self.taken:
            rows.popleft()
        self.taken = i["row_taken_i"]
        if i["rst_i"]:
            rows.clear()
            self.taken = 0
        elif load and i["ctx_valid_i"]:
            c = CONTEXT.unpack(i["ctx_i"])
            count = c["offsets_y"] if c["status"] == Status.OK else 1
            rows.extend(ROW.pack({"tag": c["tag"], "status": c["status"], "last_x": (c["offsets_x"] - 1) % 1024,
                                  "y": y, "first": y == 0, "last": y == count - 1}) for y in range(count))
            self.scoring = SCORING.pack({**c, "one": c["offsets_x"] == 1, "two": c["offsets_x"] == 2})
        return out


class IntakeModel:
    """`slog_peak_intake`: scores with their places, two clocks after they are taken."""

    INPUTS = ("rst_i", "row_coming_i", "row_refused_i", "row_last_x_i", "row_first_i", "row_last_i", "scoring_i",
              "released_i", "mismatch_valid_i", "mismatch_i", "surf_ok_i")
    OUTPUTS = ("row_taken_o", "mismatch_ready_o", "score_valid_o", "score_first_o", "score_last_o", "score_x_o",
               "score_o", "bank_o", "surf_valid_o", "surf_first_o", "surf_last_o")
    SCORE = OUTPUTS[3:7]

    def __init__(self, banks: int) -> None:
        self.banks = banks
        self.clear()

    def clear(self) -> None:
        """No row begun; the first one goes into bank 0."""
        self.row: Inputs | None = None
        self.x, self.bank, self.used, self.open, self.surf_ok = 0, self.banks - 1, 0, 0, 0
        self.flying: deque[Outputs | None] = deque([None, None])

    @property
    def willing(self) -> bool:
        """Takes a score in this clock."""
        return self.row is not None and bool(self.surf_ok or not SCORING.unpack(self.row["scoring_i"])["surface"])

    @property
    def ends(self) -> bool:
        """The next score is its row's last."""
        return self.row is not None and self.x == self.row["row_last_x_i"]

    def takes(self, mismatch_valid: int) -> bool:
        """Takes a row in this clock."""
        return bool(self.open and (self.row is None or (mismatch_valid and self.willing and self.ends)))

    def step(self, i: Inputs) -> Outputs:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        row, now, willing, ends = self.row, self.flying[0], self.willing, self.ends
        take = self.takes(i["mismatch_valid_i"])
        out: Outputs = {"row_taken_o": int(take), "mismatch_ready_o": int(willing),
                        "score_valid_o": int(now is not None), "bank_o": 0, "surf_valid_o": 0,
                        **dict.fromkeys((*self.SCORE, "surf_first_o", "surf_last_o")), **(now or {})}
        if i["rst_i"]:
            self.clear()
            return out
        scored: Outputs | None = None
        if willing and i["mismatch_valid_i"] and row is not None:
            begins, scoring = self.x == 0, SCORING.unpack(row["scoring_i"])
            surface = scoring["surface"]
            scored = {"score_first_o": int(begins), "score_last_o": int(ends), "score_x_o": self.x,
                      "score_o": scoring["area"] - i["mismatch_i"], "bank_o": 1 << self.bank, "surf_valid_o": surface,
                      "surf_first_o": int(begins and row["row_first_i"]) if surface else None,
                      "surf_last_o": int(ends and row["row_last_i"]) if surface else None}
            self.x += 1
            if ends:
                self.row = None
        self.flying.popleft()
        self.flying.append(scored)
        self.open = int(i["row_coming_i"] and not take and (self.used < self.banks or i["released_i"] > 0))
        self.surf_ok = i["surf_ok_i"]
        self.used += take - i["released_i"]
        if take:
            self.bank = (self.bank + 1) % self.banks
            if not i["row_refused_i"]:
                self.row, self.x = dict(i), 0
        return out


class BestModel:
    """`slog_peak_best`: per row, whether it is its job's best so far; from the maxima of all rows of the job."""

    INPUTS = ("rst_i", "row_valid_i", "row_i", "top_level_i", "top_coming_i", "top_score_i", "top_x_i", "room_i",
              "order_room_i")
    OUTPUTS = ("row_ready_o", "top_ready_o", "order_valid_o", "outcome_valid_o", "order_o", "outcome_o",
               "released_o")

    def __init__(self) -> None:
        self.clear()
        self.row: dict[str, int] = {}
        self.tops: list[tuple[int, int]] = []
        """(score, x) of the job's rows up to this one."""

    def clear(self) -> None:
        """No row."""
        self.held, self.hand, self.complete = False, False, False
        """A row is held; it leaves in this clock; the row that waits could be taken."""

    def decided(self) -> tuple[int, int]:
        """Order and outcome of the row."""
        row, tops = self.row, self.tops
        if row["status"] != Status.OK:
            return (SCAN.pack({"fresh": 1, "last": row["last"], "above": not row["first"], "middle": 0,
                               "below": not row["last"], "only": 1, "brief": 1, "last_x": row["last_x"],
                               "best_x": 0}),
                    OUTCOME.pack({**row, "fresh": 1, "other": 0, "best_x": 0, "best_y": row["y"], "score": 0}))
        scores = [score for score, _ in tops]
        r, best = len(tops) - 1, scores.index(max(scores))
        fresh = best == r
        # What the scan will not see: rows above its three, or, without a scan, a row below the neighbourhood.
        candidates = scores[:max(r - 1, 0)] if fresh else scores[r:] if r >= best + 2 else []
        order = {"fresh": fresh, "last": row["last"], "above": not row["first"], "middle": 1,
                 "below": not row["last"], "only": not (fresh and row["last_x"]),
                 "brief": not (fresh and row["last_x"] > 1), "last_x": row["last_x"], "best_x": tops[r][1]}
        outcome = {**row, "fresh": fresh, "other": PRESENT + max(candidates) if candidates else 0,
                   "best_x": tops[best][1], "best_y": best, "score": PRESENT + scores[best]}
        return SCAN.pack(order), OUTCOME.pack(outcome)

    def step(self, i: Inputs) -> Outputs:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        hand, row = self.hand, self.row
        coming = ROW.unpack(i["row_i"])
        refused = coming["status"] != Status.OK
        load = self.complete and (hand or not self.held)
        order, outcome = self.decided() if hand else (None, None)
        out: Outputs = {"row_ready_o": int(load), "top_ready_o": int(load and not refused),
                        "order_valid_o": int(hand), "outcome_valid_o": int(hand), "order_o": order,
                        "outcome_o": outcome,
                        "released_o": (not row["first"]) + row["last"] if hand else 0}
        level = i["top_level_i"] + i["top_coming_i"]
        self.complete = bool(i["row_valid_i"] and (refused or level >= 2 or (coming["last"] and level)))
        self.hand = self.held and not hand and bool(i["order_room_i"] and (i["room_i"] or not row["last"]))
        self.held = load or (self.held and not hand)
        if load:
            self.row = coming
            self.tops = [] if coming["first"] else self.tops
            self.tops.append((i["top_score_i"], i["top_x_i"]))
        if i["rst_i"]:
            self.clear()
        return out


class ScanModel:
    """`slog_peak_scan`: columns near the best three clocks after their read, the best of all others ten."""

    INPUTS = ("rst_i", "order_valid_i", "order_i", "data_i")
    FLAGS = ("near_end_o", "near_first_o", "near_west_o", "near_centre_o", "near_east_o")
    VALUES = ("near_above_o", "near_middle_o", "near_below_o")
    OUTPUTS = ("order_room_o", "read_o", "read_x_o", *FLAGS, *VALUES, "far_valid_o", "far_o")

    def __init__(self, banks: int) -> None:
        self.banks = banks
        self.clear()

    def clear(self) -> None:
        """Idle; the next row lies in bank 0."""
        self.order: dict[str, int] | None = None
        self.x, self.bank = 0, self.banks - 1
        self.wait = False
        """The clock before an only column."""
        self.reading: deque[tuple[dict[str, int], int, int] | None] = deque([None, None])
        self.near: Outputs | None = None
        self.outside: list[int] = []
        self.far: deque[int | None] = deque([None] * 8)

    @property
    def room(self) -> bool:
        """An order may come in the next clock, if none comes in this one."""
        return self.order is None or self.wait or self.x >= self.order["last_x"] - 1

    def step(self, i: Inputs) -> Outputs:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        o, banks = self.order, self.banks
        read = 0
        if o is not None:
            read = sum(1 << (self.bank + d) % banks
                       for name, d in (("above", -1), ("middle", 0), ("below", 1)) if o["fresh"] and o[name])
        far = self.far.popleft()
        out: Outputs = {"order_room_o": int(self.room), "read_o": read, "read_x_o": self.x if o else None,
                        **dict.fromkeys(self.FLAGS, 0), **dict.fromkeys(self.VALUES), **(self.near or {}),
                        "far_valid_o": int(far is not None), "far_o": far}
        o = None if self.wait else o
        if i["rst_i"]:
            self.clear()
            return out
        # The column read two clocks ago has its data.
        column = self.reading.popleft()
        self.reading.append((o, self.x, self.bank) if o is not None else None)
        self.near, done = None, None
        if column is not None:
            done = self.take_column(*column, i["data_i"])
        self.far.append(done)
        self.wait = False
        if o is not None:
            self.order, self.x = (None, 0) if self.x == o["last_x"] else (o, self.x + 1)
        if i["order_valid_i"]:
            self.order, self.x, self.bank = SCAN.unpack(i["order_i"]), 0, (self.bank + 1) % banks
            self.wait = bool(self.order["only"])
            self.order["last_x"] *= not self.wait
        return out

    def take_column(self, o: dict[str, int], x: int, bank: int, data: int) -> int | None:
        """Note a column; returns the best outside the neighbourhood when the row is through."""
        values = [PRESENT + (data >> (bank + d) % self.banks * SCORE_BITS) % PRESENT if o["fresh"] and o[name] else 0
                  for name, d in (("above", -1), ("middle", 0), ("below", 1))]
        side = x - o["best_x"]
        self.near = {"near_end_o": int(o["last"] and x == o["last_x"]), "near_first_o": int(x == 0),
                     "near_west_o": int(side == -1), "near_centre_o": int(side == 0), "near_east_o": int(side == 1),
                     **dict(zip(("near_above_o", "near_middle_o", "near_below_o"), values, strict=True))}
        if not o["fresh"]:
            self.near = {"near_end_o": self.near["near_end_o"]}
        if x == 0:
            self.outside = []
        self.outside += values if abs(side) > 1 else [0]
        return max(self.outside) if x == o["last_x"] else None


class CollectModel:
    """`slog_peak_collect`: a job's neighbours, and its verdict three clocks after its last row's scan."""

    INPUTS = ("rst_i", "near_first_i", "near_end_i", "near_west_i", "near_centre_i", "near_east_i",
              "near_above_i", "near_middle_i", "near_below_i", "far_valid_i", "far_i", "outcome_i")
    OUTPUTS = ("around_valid_o", "around_o", "verdict_valid_o", "verdict_o")
    COLUMNS = (("near_west_i", (0, 3, 5)), ("near_centre_i", (1, None, 6)), ("near_east_i", (2, 4, 7)))

    def __init__(self) -> None:
        self.around = [0] * 8
        self.ended = 0
        self.runner_up = 0
        self.verdicts: deque[int | None] = deque([None] * 3)

    def step(self, i: Inputs) -> Outputs:
        """Outputs of this clock from the state and the inputs `i`, then the clock edge."""
        verdict = self.verdicts.popleft()
        around = sum(or_no_score(v) << k * SCORE_BITS for k, v in enumerate(self.around))
        out: Outputs = {"around_valid_o": self.ended, "around_o": around if self.ended else None,
                        "verdict_valid_o": int(verdict is not None), "verdict_o": verdict}
        self.ended = i["near_end_i"]
        if i["near_first_i"]:
            self.around = [0] * 8
        for flag, places in self.COLUMNS:
            for place, row in zip(places, ("near_above_i", "near_middle_i", "near_below_i"), strict=True):
                if i[flag] and place is not None:
                    self.around[place] = i[row]
        done = None
        if i["far_valid_i"]:
            o = OUTCOME.unpack(i["outcome_i"])
            self.runner_up = max(o["other"], i["far_i"] if o["fresh"] else self.runner_up)
            if o["last"]:
                done = VERDICT.pack({**o, "score": or_no_score(o["score"]), "runner_up": or_no_score(self.runner_up)})
        self.verdicts.append(done)
        if i["rst_i"]:
            self.ended, self.verdicts = 0, deque([None] * 3)
        return out
