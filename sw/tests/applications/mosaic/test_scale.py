# SPDX-License-Identifier: Apache-2.0
"""Long surveys: the bookkeeping a frame does not grow with their length, and places what solving the whole places.

`make endurance` holds the processor time a frame of a survey with pictures, at 2,000 frames, to the same bar.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest

from signum.applications.mosaic import graph, ledger, local_solution, loop_closures
from signum.applications.mosaic.edges import LOOP, SEQUENCE
from signum.applications.mosaic.graph import solve_graph
from signum.applications.mosaic.ledger import Piece
from signum.applications.mosaic.local_solution import Knowledge, solve_window
from signum.applications.mosaic.nearby import CentreGrid, ball, edges_among
from signum.applications.mosaic.settings import SurveySettings
from signum.applications.mosaic.survey import Survey
from signum.geometry.similarity import Similarity, overlap
from signum.measure.register import Registrar
from tests.applications.mosaic.imagined import CENTRE, SIZE, TruthRegistrar, imagined, lanes, ring


@pytest.fixture(autouse=True)
def _no_disk(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is written need not reach the disk."""
    monkeypatch.setattr("os.fsync", lambda handle: None)


def _survey(registrar: TruthRegistrar, out: Path) -> Survey:
    return Survey(cast(Registrar, registrar), out)


def _centres(places: dict[str, Similarity]) -> np.ndarray[Any, Any]:
    return np.array([complex(*place(CENTRE)) for _, place in sorted(places.items())])


def _flown(count: int, along: int, out: Path) -> Iterator[Survey]:
    survey = _survey(TruthRegistrar(lanes(count, along)), out)
    for k in range(count):
        survey.add(imagined(k))
        yield survey


def test_the_work_a_frame_does_not_grow(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Edges in all steps of least squares, and pairs whose overlap is looked at, a frame: 120 frames against 50."""
    work = 0
    linear = graph._System.linear

    def counted(system: Any, poses: Any) -> Any:
        nonlocal work
        work += len(system.a)
        return linear(system, poses)

    def looked(similarity: Similarity, size: tuple[int, int]) -> float:
        nonlocal work
        work += 1
        return overlap(similarity, size)

    monkeypatch.setattr(graph._System, "linear", counted)
    monkeypatch.setattr(loop_closures, "overlap", looked)
    spent = [0]
    for survey in _flown(140, 8, tmp_path):  # noqa: B007
        spent.append(work)
    early, late = (spent[60] - spent[40]) / 20, (spent[140] - spent[100]) / 40
    print(f"{early:.0f} edges and pairs a frame at 50, {late:.0f} at 120 ({late / early:.2f}x)")
    assert late <= 1.2 * early
    for _ in survey.finish():
        pass
    assert work - spent[-1] <= 20 * len(survey.edges), "the last look for edges is a few steps on the whole"
    survey.leave()


def test_the_places_are_those_of_the_whole(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As the survey grows, and the same edges and places at its end."""
    parts = _flown(84, 8, tmp_path / "parts")
    off = []
    for survey in parts:
        if len(survey.pieces[0].stored) % 4 == 0 and len(survey.pieces[0].stored) > 64:
            piece = survey.pieces[0]
            whole = solve_graph(piece.stored[0], survey.ledger.edges_of(piece), SIZE, piece.places)
            off.append(np.abs(_centres(piece.places) - _centres(whole.places)).max())
    assert len(off) == 5 and max(off) < 6 and np.median(off) < 3
    monkeypatch.setattr(ledger, "WHOLE", 10**9)
    *_, other = _flown(84, 8, tmp_path / "whole")
    for one in (survey, other):
        for _ in one.finish():
            pass
        one.leave()
    assert {(e.frame_a, e.frame_b) for e in survey.ledger.accepted} == \
        {(e.frame_a, e.frame_b) for e in other.ledger.accepted}
    apart = np.abs(_centres(survey.pieces[0].places) - _centres(other.pieces[0].places))
    assert apart.max() < 0.01


def test_a_long_way_round_is_closed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """64 frames round a square, without edges between: more than a part holds. Its first frame is found all the same,
    as soon as the whole has been solved, and at the latest in the last look."""
    monkeypatch.setattr(ledger, "WHOLE", 20)
    monkeypatch.setattr(local_solution, "BETWEEN", 40)
    registrar = TruthRegistrar(ring(16), noise=0.2)
    survey = _survey(registrar, tmp_path)
    for k in range(len(registrar.truth)):
        survey.add(imagined(k))
    for _ in survey.finish():
        pass
    survey.leave()
    closing = [e for e in survey.edges if e.accepted and e.kind == LOOP and int(e.frame_b) - int(e.frame_a) > 50]
    assert len(closing) >= 4
    piece = survey.pieces[0]
    miss = complex(*piece.places[imagined(64).name](CENTRE)) - complex(*piece.places[imagined(0).name](CENTRE))
    assert abs(miss) < 2, "the way ends where it began"


@pytest.fixture(scope="module")
def piece(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Survey, Piece]]:
    *_, survey = _flown(90, 10, tmp_path_factory.mktemp("survey"))
    survey.ledger.solve(survey.pieces[0])
    yield survey, survey.pieces[0]
    survey.leave()


def test_a_part_of_a_solved_whole_stays(piece: tuple[Survey, Piece]) -> None:
    """The frames around stand still in the right places: nothing moves, and a frame that is pushed away comes back."""
    survey, whole = piece
    for name in (whole.stored[55], whole.stored[-1], whole.stored[1]):
        found, moved = solve_window(survey.ledger.links, whole.places, whole.stored[0], name, 20, SIZE, 3.0)
        assert len(found) >= 19 and whole.stored[0] not in found
        assert moved < 0.3 and max(abs(_centres(found) - _centres({n: whole.places[n] for n in found}))) < 0.3
        pushed = {**whole.places, name: Similarity(shift=20 + 10j) @ whole.places[name]}
        back, _ = solve_window(survey.ledger.links, pushed, whole.stored[0], name, 20, SIZE, 3.0)
        assert abs(complex(*back[name](CENTRE)) - complex(*found[name](CENTRE))) < 0.01


def test_a_part_never_knows_more_than_the_whole(piece: tuple[Survey, Piece]) -> None:
    survey, whole = piece
    assert whole.solution is not None
    at = float(CENTRE[0]), float(CENTRE[1])
    for name in whole.stored[30::9]:
        others = [other for other in whole.near(name) if other not in survey.ledger.partners(name)][:4]
        others += whole.near(name)[:3]
        known = Knowledge(survey.ledger.links, whole.places, name, others, SIZE, 3.0, None)
        for other in others:
            part, all_of_it = known.deviation(other, name, at), whole.solution.deviation(other, name, at)
            assert part is not None and 0.95 * all_of_it <= part * whole.solution.usual / known.usual <= 2 * all_of_it


def test_what_lies_beyond_a_part_is_known_by_way_of_the_last_whole(piece: tuple[Survey, Piece]) -> None:
    survey, whole = piece
    edges = [e for e in survey.ledger.accepted if e.kind == SEQUENCE]
    links = {name: [e for e in edges if name in (e.frame_a, e.frame_b)] for name in whole.stored}
    before = solve_graph(whole.stored[0], edges[:80], SIZE)
    first, last = whole.stored[0], whole.stored[-1]
    at = float(CENTRE[0]), float(CENTRE[1])
    near = Knowledge({**links, whole.stored[60]: links[whole.stored[60]][1:]}, whole.places, last, [first], SIZE, 3.0,
                     None)
    assert near.deviation(first, last, at) is None
    known = Knowledge({**links, whole.stored[60]: links[whole.stored[60]][1:]}, whole.places, last, [first], SIZE, 3.0,
                      before)
    found, straight = known.deviation(first, last, at), solve_graph(first, edges, SIZE).deviation(first, last, at)
    assert found is not None and 0.5 * straight <= found <= 1.5 * straight


def test_near_in_the_plane_as_by_a_look_at_all() -> None:
    rng = np.random.default_rng(3)
    grid, at = CentreGrid(SIZE), {}
    for turn in range(3):  # frames move, also from cell to cell
        for k in range(300):
            place = Similarity.of(rng.uniform(-180, 180), 1.1, (rng.uniform(-3e3, 3e3), rng.uniform(-3e3, 3e3)))
            at[f"{k}"] = complex(*place(CENTRE))
            grid.put(f"{k}", place)
        for _ in range(20):
            here, reach = complex(*rng.uniform(-3e3, 3e3, 2)), float(rng.uniform(10, 900))
            near = {n for n, z in at.items() if max(abs((z - here).real), abs((z - here).imag)) <= reach}
            found = grid.near(here, reach)
            assert len(found) == len(set(found)) and set(found) == near, turn


def test_near_by_edges(piece: tuple[Survey, Piece]) -> None:
    survey, whole = piece
    links = survey.ledger.links
    name = whole.stored[44]
    around = ball(links, name, 30)
    assert len(around) == len(set(around)) == 30 and around[0] == name
    assert set(survey.ledger.partners(name)) < set(around)
    wanted = survey.ledger.partners(name)[:2]
    small = ball(links, name, 100, wanted)
    assert set(wanted) < set(small) and len(small) < 60, "it ends beyond those that are wanted"
    inside = edges_among(links, around)
    assert {id(e) for e in inside} == {id(e) for e in survey.ledger.accepted
                                       if e.frame_a in around and e.frame_b in around}


def test_small_copies_stay_within_their_memory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("signum.applications.mosaic.results.THUMBS_BYTES", 300_000)
    survey = Survey(cast(Registrar, TruthRegistrar([])), tmp_path, settings=SurveySettings())
    shape = (300, 400)
    for k in range(80):
        survey.results.show(str(k), np.full(shape, k, np.uint8))
    held = sum(thumb.nbytes for thumb in survey.results._thumbs.values())
    assert 100_000 < held <= 300_000 and len({t.shape for t in survey.results._thumbs.values()}) == 1
    survey.leave()
