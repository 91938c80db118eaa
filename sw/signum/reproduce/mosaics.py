# SPDX-License-Identifier: Apache-2.0
"""Figures 14 to 17: single-column mosaics, manual and automatic, and a survey flown back and forth."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
from matplotlib import pyplot as plt

from signum.applications.mosaic import simulate
from signum.applications.mosaic.accuracy import PoseErrors, pose_errors
from signum.applications.mosaic.blend import compose
from signum.applications.mosaic.column import fly_column
from signum.applications.mosaic.edges import SEQUENCE
from signum.applications.mosaic.graph import chain
from signum.applications.mosaic.ledger import Piece
from signum.applications.mosaic.settings import SurveySettings
from signum.applications.mosaic.simulate import Flown, Plan, ground_view, seafloor
from signum.applications.mosaic.survey import Survey
from signum.applications.mosaic.track import Track
from signum.applications.mosaic.ways import WAYS
from signum.boards.board import Board
from signum.common.arrays import Image
from signum.frames.frame import Frame
from signum.geometry.camera import LOOK_DOWN, Sight, rotation
from signum.report.page import Bar, Section, figure, paragraph, plot, row, table
from signum.reproduce import OpenBoard, Progress
from signum.reproduce.survey import registrar
from signum.world.camera import Pinhole
from signum.world.vehicle import Current, Vehicle
from signum.world.water import Water
from signum.world.world import World

IMAGES = 4
"""The paper's figure 15 has four."""
SIZE, FOCAL, HEIGHT_M = (320, 240), 400.0, 2.0


def make(open_board: OpenBoard, out: Path, seed: int, quick: bool, progress: Progress) -> list[Section]:
    """A column by hand, a column by itself, columns back and forth."""
    with open_board() as board:
        return [_column(board, out, seed, progress), _columns(board, out, seed, quick, progress)]


def _column(board: Board, out: Path, seed: int, progress: Progress) -> Section:
    camera, chain_only = Pinhole(SIZE, FOCAL), SurveySettings(loops=False)
    current = Current(steady=(0.05, 0.02), surge=(0.03, 0.015, 0.0), period=8.0)
    world = World(seafloor(8.0, 0.0, 0.8 * HEIGHT_M / FOCAL, seed), Water(noise=2.0), current=current, seed=seed)
    with progress("single column", None) as tell:
        with Survey(registrar(board, SIZE, 64, 2.5), out / "manual", settings=chain_only) as manual:
            taken = [_sight(0.38 * k - 1.2, 0.03 * (k % 2), 0.02 * (-1) ** k) for k in range(IMAGES)]
            for k, sight in enumerate(taken):
                manual.add(Frame(str(k), world.look(camera, sight).frame))
                tell(f"manual, image {k}")
        vehicle = Vehicle(current=current, position=np.array([-1.2, 0.0, -HEIGHT_M]))
        errors: list[tuple[float, float]] = []
        flown: list[Sight] = []
        with Survey(registrar(board, SIZE, 64, 2.5), out / "automatic", settings=chain_only) as automatic:
            for live in fly_column(world, vehicle, camera, automatic, IMAGES):
                errors.append(live.error)
                if live.stored > len(flown):
                    flown.append(live.sight)
                tell(f"automatic, {live.stored} images")
    off = {"manual": _off(camera, manual, taken), "automatic": _off(camera, automatic, flown)}
    pictures = [figure(_read(out / kind / "mosaic.png"), f"{kind}: {IMAGES} images of a column") for kind in off]
    fig, ax = plt.subplots(figsize=(5, 4))
    ax.plot(np.array(errors)[:, 1], label="along the column")
    ax.plot(np.array(errors)[:, 0], label="across it")
    ax.set(xlabel="live image", ylabel="px")
    ax.legend(fontsize=8)
    text = ("The section at the top centre of the stored image is found in the live image; when it has reached the "
            "bottom centre, the live image is stored and its offset recorded. In manual mode an operator takes the "
            "pictures, here a good third of a frame apart; in automatic mode the vehicle servoes the section's error "
            "to zero in a current with surge.")
    bars = tuple(Bar(f"{kind} column: last image's place against truth, px", value, "<=", 3.0)
                 for kind, value in off.items())
    return Section("Single-column mosaics, manual and automatic (figures 14 and 15)", paragraph(text) + row(
        [*pictures, plot(fig, "automatic: the section's distance from the bottom centre")]), bars)


def _sight(north: float, east: float, heading: float) -> Sight:
    return Sight(np.array([north, east, -HEIGHT_M]), rotation(0, 0, heading) @ LOOK_DOWN)


def _off(camera: Pinhole, survey: Survey, taken: list[Sight]) -> float:
    """Distance, pixels, of the last image's centre from its true place in the plane of the first; infinite where the
    column broke."""
    stored = survey.pieces[-1].stored
    if len(survey.pieces) != 1 or len(stored) != len(taken):
        return float("inf")
    true = ground_view(camera, taken[0]).inverse @ ground_view(camera, taken[-1])
    centre = np.array(camera.centre)
    return float(np.hypot(*(survey.pieces[0].places[stored[-1]](centre) - true(centre))))


def _columns(board: Board, out: Path, seed: int, quick: bool, progress: Progress) -> Section:
    side = 3 if quick else 6
    plan = Plan(rows=side, columns=side, step=(0.6, 0.6), yaw_deg=2.0)
    flown = simulate.simulate_survey(plan, seed)
    with progress("columns back and forth", side * side) as tell, \
            Survey(registrar(board, plan.size, 48, 2.0), out / "columns") as survey:
        for cell in flown.sequence():
            tell(survey.add(Frame(f"{cell[0]}-{cell[1]}", flown.frames[cell])))
        for _ in survey.finish():
            pass
    piece = survey.ranked()[0]
    truth = Track({f"{r}-{c}": flown.position((r, c)) for r, c in flown.truth}, {}, "px")
    errors = {way: pose_errors(place(survey.ledger, piece), truth) for way, place in WAYS.items()}
    heads = ("placed by", "absolute error, RMS px", "most, px", "frame to frame, RMS px")
    lines = [[way, *(f"{v:.2f}" for v in (_rms(e.ape), e.ape.max(), _rms(e.rpe)))] for way, e in errors.items()]
    worst = {way: _rms(e.ape) for way, e in errors.items()}
    text = (f"{side}x{side} frames over relief of {100 * plan.relief:.0f} cm, heading held to {plan.yaw_deg:g} "
            f"degrees, flown back and forth; {len(survey.ledger.accepted)} edges accepted of {len(survey.edges)} "
            "measured. "
            "No columns are given. A chain along the way flown (figure 16) lets neighbouring columns drift apart; as "
            "few edges as there are (figure 17) keeps them together; least squares over all of them comes last. Errors "
            "are those of the frames' centres after the best similarity.")
    bars = (Bar("frames in one component, share", len(piece.stored) / len(flown.frames), ">=", 1.0),
            Bar("all links, absolute error, RMS px", worst["all links"], "<=", 3.0),
            Bar("all links over sequence only, absolute error", worst["all links"] / worst["sequence only"], "<=", 1.0))
    return Section("Columns flown back and forth (figures 16 and 17)", paragraph(text) + row(
        [figure(_read(survey.out / "mosaic.png"), "all links, least squares"),
         figure(_by_sequence(survey, piece), "sequence only")]) + row([_ways(flown, errors, survey, piece)])
        + table(heads, lines), bars)


def _by_sequence(survey: Survey, piece: Piece) -> Image:
    """The mosaic as the sequence alone would have it."""
    edges = [edge for edge in survey.ledger.edges_of(piece) if edge.kind == SEQUENCE]
    places = chain(piece.stored[0], edges)
    return compose(survey.ledger.shelf.pictures(list(places)), list(places.values())).picture


def _ways(flown: Flown, errors: dict[str, PoseErrors], survey: Survey, piece: Piece) -> str:
    fig, axes = plt.subplots(1, len(WAYS), figsize=(12, 4))
    at = {f"{r}-{c}": flown.position((r, c)) for r, c in flown.truth}
    for ax, (way, place) in zip(axes, WAYS.items(), strict=True):
        onto = errors[way].onto
        placed = [onto.factor * complex(p.x_px, p.y_px) + onto.shift for p in place(survey.ledger, piece)]
        true = [at[name] for name in piece.stored]
        ax.plot([z.real for z in true], [z.imag for z in true], "-", color="0.8", lw=3)
        ax.plot([z.real for z in placed], [z.imag for z in placed], ".-", color="tab:red", lw=0.8)
        ax.set_title(f"{way}: {_rms(errors[way].ape):.1f} px", fontsize=9)
        ax.set_aspect("equal")
        ax.invert_yaxis()
    return plot(fig, "frame centres: truth grey, placed red; after the best similarity")


def _rms(values: np.ndarray[tuple[int], np.dtype[np.float64]]) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _read(path: Path) -> Image:
    return np.asarray(cv2.imread(str(path), cv2.IMREAD_UNCHANGED), np.uint8)
