# SPDX-License-Identifier: Apache-2.0
"""Registration of pairs of overlapping pictures: photographs with known motion, and real surveys where they are at
hand."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from signum.boards.golden import GoldenBoard
from signum.common.arrays import Floats, Image
from signum.geometry.similarity import Similarity, overlap
from signum.report.page import Section, figure, row
from signum.reproduce.reference import SHARED, Pair, read_pairs
from signum.reproduce.survey import registrar
from signum.world.seafloor import PHOTOS, photograph, quilt
from tests.compare.table import WATERS, Column, Task, Tell, in_water, rms

SIZE = 384, 288
WINDOW, SIGMA = 64, 2.5
LEAST_INLIERS = 12
"""Matches that agree, from which features' registrations count."""
WRONG_PX, WRONG_SHARE = 8.0, 0.05
"""A registration is wrong that is farther off than this, and this share of the shift."""
SETS = "skerki", "imos/test1", "imos/test5"
Register = Callable[[Image, Image], Similarity | None]
"""(a, b) -> pixels of a -> pixels of b; None where the method refuses."""


def detector(kind: str) -> Callable[[Image], tuple[Floats, np.ndarray]]:
    """Finds at most 1,500 features: places (n, 2) and descriptors."""
    made = cv2.SIFT.create(1500) if kind == "SIFT" else cv2.ORB.create(1500)

    def detect(picture: Image) -> tuple[Floats, np.ndarray]:
        points, words = made.detectAndCompute(picture, None)
        at = np.array([p.pt for p in points], np.float64).reshape(-1, 2)
        return at, np.zeros((0, 32), np.uint8) if words is None else words

    return detect


def matches(a: np.ndarray, b: np.ndarray, kind: str) -> tuple[np.ndarray, np.ndarray]:
    """Numbers of the descriptors that match, by the ratio of 0.8 to the second best."""
    if len(a) < 2 or len(b) < 2:
        return np.zeros(0, int), np.zeros(0, int)
    found = cv2.BFMatcher.create(cv2.NORM_L2 if kind == "SIFT" else cv2.NORM_HAMMING).knnMatch(a, b, 2)
    kept = [m[0] for m in found if len(m) == 2 and m[0].distance < 0.8 * m[1].distance]
    return np.array([m.queryIdx for m in kept], int), np.array([m.trainIdx for m in kept], int)


def by_features(kind: str, prepared: bool = False) -> Register:
    """Features, matches, RANSAC to 4 pixels; `prepared`: after a median filter and local contrast (CLAHE)."""
    detect, even = detector(kind), cv2.createCLAHE(4.0, (8, 8))

    def register(a: Image, b: Image) -> Similarity | None:
        if prepared:
            a, b = (np.asarray(even.apply(cv2.medianBlur(p, 5)), np.uint8) for p in (a, b))
        (p, words), (q, others) = detect(a), detect(b)
        i, j = matches(words, others, kind)
        if len(i) < LEAST_INLIERS:
            return None
        found, inside = cv2.estimateAffinePartial2D(p[i], q[j], ransacReprojThreshold=4.0)
        if found is None or inside is None or inside.sum() < LEAST_INLIERS:
            return None
        return Similarity(complex(found[0, 0], found[1, 0]), complex(found[0, 2], found[1, 2]))

    return register


def by_phase(a: Image, b: Image) -> Similarity | None:
    """Phase correlation of the whole pictures: a translation; refused below a response of 0.05."""
    hann = cv2.createHanningWindow(a.shape[::-1], cv2.CV_32F)
    (x, y), response = cv2.phaseCorrelate(a.astype(np.float32), b.astype(np.float32), hann)
    return Similarity(shift=complex(x, y)) if response >= 0.05 else None


def by_signum(size: tuple[int, int]) -> Register:
    """The golden board, as `signum mosaic` calls it."""
    own = registrar(GoldenBoard(), size, WINDOW, SIGMA)

    def register(a: Image, b: Image) -> Similarity | None:
        found = own.register(own.prepare(a), own.prepare(b))
        return found.similarity if found.accepted else None

    return register


def methods(size: tuple[int, int]) -> dict[str, Register]:
    """By name."""
    return {"Signum": by_signum(size), "ORB and RANSAC": by_features("ORB"), "SIFT and RANSAC": by_features("SIFT"),
            "SIFT after median and CLAHE": by_features("SIFT", prepared=True), "phase correlation": by_phase}


@dataclass(frozen=True, eq=False)
class Known:
    """A pair with its true similarity."""

    a: Image
    b: Image
    truth: Similarity


def known_pairs(seed: int, count: int) -> list[Known]:
    """Views of a floor that overlap by 40 % or more, turned by up to 8 degrees, scaled by up to 7 %, with noise."""
    rng = np.random.default_rng([seed, 32])
    out: list[Known] = []
    while len(out) < count:
        floor = quilt(photograph(PHOTOS[len(out) % len(PHOTOS)], float(rng.uniform(1, 1.8))), 900, rng)
        turn = Similarity.of(float(rng.uniform(-8, 8)), float(rng.uniform(0.93, 1.07)))
        middle = complex(*((n - 1) / 2 for n in SIZE))
        shift = complex(*(rng.uniform(-0.5, 0.5, 2) * SIZE))
        truth = Similarity(turn.factor, middle - turn.factor * middle + shift)
        if overlap(truth, SIZE) < 0.4:
            continue
        first = Similarity(shift=complex(258, 306))
        shots = []
        for place in (first, first @ truth.inverse):
            view = cv2.warpAffine(floor, place.matrix, SIZE, flags=cv2.INTER_CUBIC | cv2.WARP_INVERSE_MAP)
            shots.append(np.clip(np.rint(view + rng.normal(0, 1.5, view.shape)), 0, 255).astype(np.uint8))
        out.append(Known(shots[0], shots[1], truth))
    return out


def miss(found: Similarity, truth: Similarity, size: tuple[int, int]) -> float:
    """Mean distance over the quarter points of a, pixels of b."""
    at = np.array([[x * (size[0] - 1), y * (size[1] - 1)] for x in (0.25, 0.75) for y in (0.25, 0.75)])
    return float(np.hypot(*(found(at) - truth(at)).T).mean())


def _columns(reference: str) -> tuple[Column, ...]:
    return (Column("pairs found", "{:.0%}", "more"), Column("wrong ones", "{:.0f}", "less"),
            Column(f"right ones' distance from {reference}, RMS px", "{:.2f}", "less"))


def _judge(task: Task, pairs: list[Known], seed: int, tell: Tell) -> None:
    size = pairs[0].a.shape[1], pairs[0].a.shape[0]
    for water in WATERS:
        for name, register in methods(size).items():
            right, wrong = [], 0
            for k, pair in enumerate(pairs):
                a, b = (in_water(p, water, 5000 * seed + 2 * k + i) for i, p in enumerate((pair.a, pair.b)))
                with task.timed(name):
                    found = register(a, b)
                if found is not None:
                    off, middle = miss(found, pair.truth, size), np.array([(n - 1) / 2 for n in size])
                    if off > WRONG_PX + WRONG_SHARE * float(np.hypot(*(pair.truth(middle) - middle))):
                        wrong += 1
                    else:
                        right.append(off)
            task.note(name, water, len(right) / len(pairs), wrong, rms(np.array(right)))
            tell(f"{name}, {water}")


def compare_pairs(seed: int, quick: bool, tell: Tell) -> tuple[Task, Section]:
    """All methods on pairs with known motion."""
    pairs = known_pairs(seed, 2 if quick else 30)
    task = Task("Registration of pairs with known motion", _columns("the truth"))
    _judge(task, pairs, seed, tell)
    text = (f"{len(pairs)} pairs of 384x288 of quilted photographs ({', '.join(PHOTOS)}), overlapping by 40 % or more, "
            f"turned by up to 8 degrees, scaled by up to 7 %. Wrong is what lies beyond {WRONG_PX:g} px and "
            f"{WRONG_SHARE:.0%} of the shift. Phase correlation knows no rotation.")
    shown = row([figure(in_water(p, w, seed), f"{w}, {n}") for w in WATERS for n, p in (("a", pairs[0].a),
                                                                                      ("b", pairs[0].b))])
    return task, task.section(text, shown)


def _real(name: str) -> list[Known]:
    folder = SHARED / name
    files: dict[str, Path] = {f.stem: f for f in sorted(folder.glob("*")) if f.suffix in (".tif", ".png", ".jpg")}
    pictures: dict[str, Image] = {}
    for stem, file in files.items():
        grey = np.asarray(cv2.imread(str(file), cv2.IMREAD_GRAYSCALE), np.uint8)
        pictures[stem] = grey
    less = 680 / 1360 if name.startswith("imos") else 1.0

    def scaled(pair: Pair) -> Similarity:
        at = pair.similarity
        corner = complex(0.5 / less - 0.5, 0.5 / less - 0.5)
        return Similarity(at.factor, (at.factor * corner + at.shift - corner) * less)

    small = {n: np.asarray(cv2.resize(p, None, fx=less, fy=less, interpolation=cv2.INTER_AREA), np.uint8)
             for n, p in pictures.items()}
    return [Known(small[Path(a).stem], small[Path(b).stem], scaled(pair))
            for (a, b), pair in read_pairs(folder / "sift_pairs.csv").items()]


def compare_real(seed: int, quick: bool, tell: Tell) -> list[tuple[Task, Section]]:
    """All methods on the pairs of real surveys that SIFT has linked, those that are at hand."""
    text = ("Pairs that SIFT with RANSAC has linked in clear pictures (15 matches or more), which is the reference: "
            "SIFT is judged against itself. IMOS frames at half their size. Figure 8's degradation comes on top of the "
            "real water's.")
    out = []
    for k, name in enumerate(SETS):
        if not quick and (SHARED / name / "sift_pairs.csv").exists():
            task = Task(f"Registration of a real survey's pairs: {name}", _columns("SIFT's"))
            pairs = _real(name)
            _judge(task, pairs[:: max(1, len(pairs) // 16)], seed + k, tell)
            out.append((task, task.section(text)))
    return out
