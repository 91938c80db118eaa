# SPDX-License-Identifier: Apache-2.0
"""How a source's frames are scaled for the board."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from golden.params import Config
from signum.common.arrays import Floats, Image
from signum.common.errors import SourceError
from signum.frames.frame import grey, size_text


@dataclass(frozen=True)
class Fit:
    """How a source's frames are shown to the board: unscaled, or scaled down to the largest image the board takes.

    Positions are pixel centres: (0, 0) is the centre of the top left pixel in both pictures.
    """

    source: tuple[int, int]
    """Width and height of the original, pixels."""
    board: tuple[int, int]
    """Width and height as the board sees it, pixels."""

    @classmethod
    def to(cls, size: tuple[int, int], config: Config, window: int, label: str = "frame") -> Fit:
        """The fit of `size` (width, height) to a board.

        Args:
            size: of the original, pixels.
            config: the board's build.
            window: side of the correlation window, pixels of the board's image.
            label: the frame's name in the error message.

        Raises:
            SourceError: if the frame is too small for the window or for the board.
        """
        width, height = size
        scale = min(1.0, config.max_width / width, config.max_height / height)
        board = (max(1, round(width * scale)), max(1, round(height * scale)))
        least = max(window, config.min_image)
        if min(board) < least:
            seen = "" if board == size else f" ({size_text(board)} on the board)"
            remedy = (f"smaller than the {size_text((least, least))} window: choose a smaller one, e.g. --window "
                      f"{max(config.min_window, min(board) // 2)}" if min(board) >= config.min_image else
                      f"too small: the board takes {size_text((config.min_image, config.min_image))} or more")
            raise SourceError(f"{label}: {size_text(size)} pixels{seen} is {remedy}")
        return cls(size, board)

    def coarser(self, longest: int) -> Fit:
        """The fit of the same frames with a longer side of at most `longest` pixels on the board."""
        scale = min(1.0, longest / max(self.board))
        return Fit(self.source, (max(1, round(self.board[0] * scale)), max(1, round(self.board[1] * scale))))

    @property
    def factor(self) -> tuple[float, float]:
        """Original pixels per pixel of the board, across and down; 1 or more."""
        return self.source[0] / self.board[0], self.source[1] / self.board[1]

    @property
    def scaled(self) -> bool:
        """Whether the board's frames differ in size from the original ones."""
        return self.source != self.board

    def show(self, picture: Image) -> Image:
        """The frame for the board: grey uint8 (board height, board width)."""
        image = grey(picture)
        if not self.scaled:
            return np.ascontiguousarray(image)
        return np.asarray(cv2.resize(image, self.board, interpolation=cv2.INTER_AREA), np.uint8)

    def to_source(self, points: Floats) -> Floats:
        """Positions (..., 2) of the board's image in original pixels."""
        k = np.array(self.factor)
        return np.asarray((points + 0.5) * k - 0.5, np.float64)

    def to_board(self, points: Floats) -> Floats:
        """Positions (..., 2) of the original in pixels of the board's image."""
        k = np.array(self.factor)
        return np.asarray((points + 0.5) / k - 0.5, np.float64)

    def note(self) -> str:
        """One line for the user if frames are scaled, else empty."""
        if not self.scaled:
            return ""
        return (f"frames of {size_text(self.source)} are scaled to {size_text(self.board)} for the board; "
                "figures are in original pixels, those drawn in pictures in the board's")
