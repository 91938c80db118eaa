# SPDX-License-Identifier: Apache-2.0
"""What `signum flow --moving` writes: what moves by itself, as a table, masks and outlines."""

from __future__ import annotations

from signum.commands.session import Session
from signum.common.files import name_part, write_picture
from signum.frames.frame import Frame
from signum.measure.flow import FlowField
from signum.measure.measurer import Measurer, View
from signum.measure.moving import Moving, segment_moving
from signum.report.outlines import mask_picture
from signum.report.rows import moving_rows
from signum.tables.schemas import MOVING


class MovingRecord:
    """Finds what moves by itself from frame to frame, and writes `moving.csv` and the masks.

    Args:
        run: the session.
        reach: largest motion against the background that is searched for, pixels of the board's picture.
    """

    def __init__(self, run: Session, reach: int) -> None:
        self._run, self._reach = run, reach
        self.objects = 0
        self._table = run.table("moving.csv", MOVING)

    def find(self, measurer: Measurer, views: tuple[View, View], field: FlowField) -> Moving:
        """What moves by itself between two views, of which the field is the flow."""
        found = segment_moving(measurer, *views, field, self._reach)
        self.objects += len(found.objects)
        self._run.refused["pairs of frames without a common motion"] += found.background is None
        return found

    def write(self, before: Frame, after: Frame, moving: Moving, picture: bool) -> None:
        """Write a pair's rows and, with `picture`, its mask."""
        for row in moving_rows(before, after, moving, self._run.fit):
            self._table.write(row)
        if picture:
            write_picture(self._run.file(f"moving_{name_part(before.name)}.png"), mask_picture(moving))

    @property
    def said(self) -> str:
        """What was found, for the line at the end."""
        return f"; {self.objects} objects that move by themselves: {self._run.folder / 'moving.csv'}"
