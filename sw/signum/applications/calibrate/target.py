# SPDX-License-Identifier: Apache-2.0
"""The boards that a camera is calibrated with: a chessboard, or a ChArUco board, whose squares hold coded markers.

Of a chessboard all inner corners must be in view; of a ChArUco board a part is enough, as its markers tell which, so
that it reaches the picture's edges, where the distortion is largest.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cached_property
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from signum.common.arrays import Floats, Image
from signum.common.errors import SignumError

LEAST_CORNERS = 8
"""Fewest corners of a view that is used."""
SEARCHED = 640
"""Longer side of the picture in which squares are looked for before a chessboard is in the whole one, pixels."""
CLEAR = 0.7
"""Half side of the window in which a ChArUco corner is refined, as a share of the gap between corner and marker."""
ENOUGH = cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 40, 1e-3
"""When a corner is found: steps, and change in pixels."""
DICTIONARIES = tuple(name for name in ("4X4_50", "4X4_100", "4X4_250", "4X4_1000", "5X5_50", "5X5_100", "5X5_250",
                                       "5X5_1000", "6X6_50", "6X6_100", "6X6_250", "6X6_1000", "7X7_50", "7X7_100",
                                       "7X7_250", "7X7_1000", "ARUCO_ORIGINAL", "APRILTAG_36h11"))
"""Sets of markers, by OpenCV's names without `DICT_`."""


class TargetKind(StrEnum):
    """Kinds of boards."""

    charuco = "charuco"
    chessboard = "chessboard"


@dataclass(frozen=True, eq=False)
class Sighting:
    """Corners of a board in a picture.

    Attributes:
        ids: number of each corner on the board (n,).
        points: where they are on the board, metres (n, 3), z = 0.
        corners: where they are in the picture, pixels (n, 2).
    """

    ids: NDArray[np.int64]
    points: Floats
    corners: Floats

    def only(self, ids: NDArray[Any]) -> Sighting:
        """The corners of these numbers, each of which is in view, in their order."""
        where = {int(number): k for k, number in enumerate(self.ids)}
        at = [where[int(number)] for number in ids]
        return Sighting(self.ids[at], self.points[at], self.corners[at])

    @cached_property
    def outline(self) -> Floats:
        """Where the corners of a rectangle round the seen ones would be in a plain picture, pixels (4, 2)."""
        plane, _ = cv2.findHomography(self.points[:, :2], self.corners)
        low, high = self.points[:, :2].min(0), self.points[:, :2].max(0)
        box = np.array([[[low[0], low[1]]], [[high[0], low[1]]], [[high[0], high[1]]], [[low[0], high[1]]]])
        if plane is None:
            return np.asarray(np.repeat(self.corners.mean(0)[None], 4, 0), np.float64)
        return np.asarray(cv2.perspectiveTransform(box, np.asarray(plane)), np.float64).reshape(4, 2)


@dataclass(frozen=True)
class SquareBoard:
    """A board.

    Attributes:
        kind: chessboard or ChArUco.
        squares: how many it has across and down, black and white ones.
        square_m: side of a square, metres.
        marker_m: side of a marker, metres.
        dictionary: set of markers, one of DICTIONARIES.
        legacy: whether a ChArUco board begins with a marker at its top left, as those of OpenCV before 4.6 with an even
            number of rows do.
    """

    kind: TargetKind
    squares: tuple[int, int]
    square_m: float
    marker_m: float
    dictionary: str
    legacy: bool = False

    def find(self, picture: Image) -> Sighting | None:
        """The board's corners in a picture, uint8 (H, W); None where fewer than LEAST_CORNERS are found."""
        if self.kind is TargetKind.chessboard:
            found, numbers = self._chessboard(picture), np.arange((self.squares[0] - 1) * (self.squares[1] - 1))
        else:
            seen, ids, _, _ = self._detector.detectBoard(picture)
            found = None if seen is None or len(seen) < LEAST_CORNERS else self._refined(picture, np.asarray(seen))
            numbers = np.zeros(0, np.int64) if ids is None else np.asarray(ids, np.int64).ravel()
        if found is None or len(found) < LEAST_CORNERS:
            return None
        points = self._grid[numbers]
        if min(np.ptp(points[:, 0]), np.ptp(points[:, 1])) < 0.9 * self.square_m:
            return None  # all in a row: no plane
        return Sighting(np.asarray(numbers, np.int64), points, found)

    def draw(self, pixels: int) -> Image:
        """The board for printing, uint8 (H, W), `pixels` for a square's side and around the board."""
        size = (self.squares[0] + 2) * pixels, (self.squares[1] + 2) * pixels
        if self.kind is TargetKind.charuco:
            return np.asarray(self._board.generateImage(size, marginSize=pixels), np.uint8)
        out = np.full(size[::-1], 255, np.uint8)
        for j in range(self.squares[1]):
            for i in range(j % 2, self.squares[0], 2):
                out[(j + 1) * pixels:(j + 2) * pixels, (i + 1) * pixels:(i + 2) * pixels] = 0
        return out

    def other(self, pictures: Sequence[Image]) -> SquareBoard | None:
        """A board of another kind of layout that is found where this one is not; None if there is none.

        Looked for: the older ChArUco layout, rows and columns exchanged, other sets of markers, and a chessboard whose
        inner corners were counted instead of its squares.
        """
        across, down = self.squares
        if self.kind is TargetKind.chessboard:
            tries = [replace(self, squares=s) for s in ((across + 1, down + 1), (down, across), (down + 1, across + 1))]
        else:
            layouts = [replace(self, legacy=legacy, squares=s) for s in ((across, down), (down, across))
                       for legacy in (False, True)]
            tries = [replace(one, dictionary=name) for name in (self.dictionary, *DICTIONARIES) for one in layouts]
        return next((one for one in tries if one != self and one._holds_markers
                     and any(one.find(p) is not None for p in pictures)), None)

    def __str__(self) -> str:
        text = f"{self.kind} of {self.squares[0]} x {self.squares[1]} squares of {1e3 * self.square_m:g} mm"
        return text if self.kind is TargetKind.chessboard else (
            f"{text}, markers of {1e3 * self.marker_m:g} mm of {self.dictionary}{', older layout' * self.legacy}")

    def _refined(self, picture: Image, corners: NDArray[Any]) -> Floats:
        """Corners (n, 2) refined each in a window that no marker reaches into, whatever the board's slant there."""
        rough = corners.reshape(-1, 2)
        apart = np.hypot(*(rough[:, None] - rough[None]).transpose(2, 0, 1))
        np.fill_diagonal(apart, np.inf)
        gap = CLEAR * (1 - self.marker_m / self.square_m) / 2
        out = np.empty((len(rough), 2))
        for k, side in enumerate(np.maximum(2, np.rint(gap * apart.min(1))).astype(int)):
            point = rough[k].astype(np.float32).reshape(1, 1, 2).copy()
            found = cv2.cornerSubPix(picture, point, (int(side), int(side)), (-1, -1), ENOUGH)
            out[k] = np.asarray(found).ravel()
        return out

    @property
    def _holds_markers(self) -> bool:
        needed = self.squares[0] * self.squares[1] // 2
        return self.kind is TargetKind.chessboard or needed <= len(self._markers.bytesList)

    @cached_property
    def _markers(self) -> Any:
        return cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, f"DICT_{self.dictionary}"))

    @cached_property
    def _board(self) -> Any:
        if not self._holds_markers:
            raise SignumError(f"a ChArUco board of {self.squares[0]} x {self.squares[1]} squares needs "
                              f"{self.squares[0] * self.squares[1] // 2} markers, {self.dictionary} has "
                              f"{len(self._markers.bytesList)}: choose another --dictionary")
        board = cv2.aruco.CharucoBoard(self.squares, self.square_m, self.marker_m, self._markers)
        board.setLegacyPattern(self.legacy)
        return board

    @cached_property
    def _detector(self) -> Any:
        return cv2.aruco.CharucoDetector(self._board)

    @cached_property
    def _grid(self) -> Floats:
        """Inner corners in the order of their numbers: (n, 3) metres."""
        i, j = np.meshgrid(np.arange(1, self.squares[0]), np.arange(1, self.squares[1]))
        return np.asarray(np.stack([i.ravel(), j.ravel(), np.zeros(i.size)], -1) * self.square_m, np.float64)

    def _chessboard(self, picture: Image) -> Floats | None:
        """All inner corners (n, 2), or None. The search takes long where there is no board: a quick one, in a small
        picture, goes before."""
        inner = self.squares[0] - 1, self.squares[1] - 1
        factor = min(1.0, SEARCHED / max(picture.shape))
        small = picture if factor == 1 else cv2.resize(picture, None, fx=factor, fy=factor,
                                                       interpolation=cv2.INTER_AREA)
        if not cv2.checkChessboard(np.asarray(small, np.uint8), inner):
            return None
        flags = cv2.CALIB_CB_NORMALIZE_IMAGE | cv2.CALIB_CB_ACCURACY
        found, corners = cv2.findChessboardCornersSB(picture, inner, flags=flags)
        return np.asarray(corners, np.float64).reshape(-1, 2) if found else None
