# SPDX-License-Identifier: Apache-2.0
"""Mosaics of a simulated survey flown back and forth, judged by the frames' places; real surveys as pictures."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

import cv2
import numpy as np

from signum.applications.mosaic.accuracy import pose_errors
from signum.applications.mosaic.blend import compose
from signum.applications.mosaic.pose import Pose
from signum.applications.mosaic.simulate import Plan, back_and_forth, simulate_survey
from signum.applications.mosaic.survey import Survey
from signum.applications.mosaic.track import Track
from signum.boards.golden import GoldenBoard
from signum.common.arrays import Image
from signum.frames.frame import Frame
from signum.geometry.similarity import IDENTITY, Similarity
from signum.report.page import Section, figure, row
from signum.reproduce.reference import SHARED
from signum.reproduce.survey import registrar
from tests.compare.registers import by_features, by_phase
from tests.compare.table import WATERS, Column, Task, Tell, in_water, rms

SIZE = 320, 240
WINDOW, SIGMA = 48, 2.0
SHOWN = 520
"""Longer side of a picture on the page, pixels."""
Placed = dict[int, Similarity]
"""Number of a frame -> its pixels -> mosaic plane; the frames that could be placed together."""
Placing = Callable[[Sequence[Image]], tuple[Placed, Image | None]]
"""Frames in the order flown -> the largest set placed, and the method's own picture if it makes one."""


def by_survey(frames: Sequence[Image]) -> tuple[Placed, Image | None]:
    """`signum mosaic` with all neighbours linked."""
    size = frames[0].shape[1], frames[0].shape[0]
    with tempfile.TemporaryDirectory() as folder, GoldenBoard() as board, \
            Survey(registrar(board, size, WINDOW, SIGMA), Path(folder)) as survey:
        for k, frame in enumerate(frames):
            survey.add(Frame(str(k), frame))
        for _ in survey.finish():
            pass
        piece = survey.ranked()[0]
        return {int(name): piece.place(name) for name in piece.frames}, None


def by_chain(register: Callable[[Image, Image], Similarity | None]) -> Placing:
    """Each frame against the one before; where a link fails, a new chain begins."""
    def place(frames: Sequence[Image]) -> tuple[Placed, Image | None]:
        chains: list[Placed] = [{0: IDENTITY}]
        for k in range(1, len(frames)):
            onto = register(frames[k], frames[k - 1])
            if onto is None:
                chains.append({k: IDENTITY})
            else:
                chains[-1][k] = chains[-1][k - 1] @ onto
        return max(chains, key=len), None
    return place


def by_stitcher(frames: Sequence[Image]) -> tuple[Placed, Image | None]:
    """OpenCV's Stitcher in its mode for scans, all settings its own."""
    stitcher = cv2.Stitcher.create(cv2.Stitcher_SCANS)
    status, picture = stitcher.stitch([np.asarray(cv2.cvtColor(f, cv2.COLOR_GRAY2BGR), np.uint8) for f in frames])
    if status != cv2.Stitcher_OK:
        return {}, None
    placed, less = {}, stitcher.workScale()
    for number, camera in zip(stitcher.component(), stitcher.cameras(), strict=True):
        m = np.asarray(camera.R, np.float64)
        # The nearest similarity to the affine map, which takes the plane to pixels at the scale of the work.
        factor = complex(m[0, 0] + m[1, 1], m[1, 0] - m[0, 1]) / 2
        placed[int(number)] = Similarity(factor, complex(m[0, 2], m[1, 2]) / less).inverse
    return placed, np.asarray(picture, np.uint8)


METHODS: dict[str, Placing] = {
    "Signum, all links": by_survey, "ORB chain": by_chain(by_features("ORB")),
    "SIFT chain": by_chain(by_features("SIFT")), "phase correlation chain": by_chain(by_phase),
    "OpenCV Stitcher (SCANS)": by_stitcher}


def small(picture: Image) -> Image:
    """A picture for the page."""
    less = min(1.0, SHOWN / max(picture.shape[:2]))
    return np.asarray(cv2.resize(picture, None, fx=less, fy=less, interpolation=cv2.INTER_AREA), np.uint8)


def _residual(placed: Placed, truth: Track, names: Sequence[str]) -> float:
    """RMS distance of the frames' centres from the truth after the best similarity, pixels."""
    if len(placed) < 3:
        return float("nan")
    middle = (SIZE[0] - 1) / 2, (SIZE[1] - 1) / 2
    return rms(pose_errors([Pose.of(names[k], place, middle, None) for k, place in placed.items()], truth).ape)


def compare_mosaics(seed: int, quick: bool, tell: Tell) -> tuple[Task, Section]:
    """All methods on a simulated survey in both waters."""
    side = 2 if quick else 6
    plan = Plan(rows=side, columns=side, size=SIZE, focal=375.0, step=(0.5, 0.55), yaw_deg=2.0)
    flown = simulate_survey(plan, seed)
    cells = back_and_forth(side, side)
    names = [f"{r}-{c}" for r, c in cells]
    truth = Track({f"{r}-{c}": flown.position((r, c)) for r, c in flown.truth}, {}, "px")
    task = Task("Mosaics of a survey flown back and forth", (
        Column("frames placed together", "{:.0%}", "more"), Column("centres from the truth, RMS px", "{:.2f}", "less")))
    shown = []
    for water in WATERS:
        frames = [in_water(flown.frames[cell], water, 7000 * seed + k) for k, cell in enumerate(cells)]
        for name, place in METHODS.items():
            with task.timed(name):
                placed, picture = place(frames)
            task.note(name, water, len(placed) / len(frames), _residual(placed, truth, names))
            if name == "Signum, all links" or (picture is None and len(placed) > 2):
                picture = compose([frames[k] for k in placed], list(placed.values())).picture
            if picture is not None and name != "phase correlation chain":
                shown.append(figure(small(picture), f"{name}, {water}"))
            tell(f"{name}, {water}")
    text = (f"{side * side} frames of {SIZE[0]}x{SIZE[1]} over relief of {100 * plan.relief:.0f} cm, half a frame "
            "apart, heading held to 2 degrees. A chain ends where a link fails, and the longest counts; the residual "
            "is that of the frames it placed, after the best similarity: few frames are placed well more easily than "
            "many. The chains' pictures are blended by Signum. Processor seconds of Signum are those of its golden "
            "model; the Stitcher's contain its blending.")
    return task, task.section(text, row(shown))


def compare_real_mosaics(seed: int, quick: bool, tell: Tell) -> Section | None:
    """Pictures of real surveys by Signum and by the Stitcher; None where they are not at hand."""
    if quick or not (SHARED / "skerki").is_dir():
        return None
    from signum.report.page import paragraph

    shown = []
    for water in WATERS:
        frames = [in_water(np.asarray(cv2.imread(str(f), cv2.IMREAD_GRAYSCALE), np.uint8), water, 9000 * seed + k)
                  for k, f in enumerate(sorted((SHARED / "skerki").glob("*.tif")))]
        placed, _ = by_survey(frames)
        picture = compose([frames[k] for k in placed], list(placed.values())).picture
        shown.append(figure(small(picture), f"Signum, {water}: {len(placed)} of {len(frames)} frames"))
        placed, stitched = by_stitcher(frames)
        if stitched is not None:
            shown.append(figure(small(stitched), f"Stitcher, {water}: {len(placed)} of {len(frames)} frames"))
        tell(f"skerki, {water}")
    return Section("Mosaics of a real survey", paragraph(
        "Thirteen frames of the Skerki Bank survey, two columns. Where the Stitcher shows nothing, it has failed.")
        + row(shown))
