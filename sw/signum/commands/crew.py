# SPDX-License-Identifier: Apache-2.0
"""The options of `signum mosaic` for surveys of which all frames are there."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from signum.applications.mosaic.crew import Bench, Cluster, Crew, Processes, processors
from signum.applications.mosaic.journal import SurveyRun
from signum.applications.mosaic.shelf import JOURNAL
from signum.common.console import notes
from signum.common.files import real_path

BATCH_GROUP = "All frames at once"


@dataclass(frozen=True)
class BatchOptions:
    """Whether the frames are measured all at once, and who measures them."""

    batch: Annotated[bool, typer.Option(
        "--batch/--in-order", rich_help_panel=BATCH_GROUP, help="For a folder of pictures that are all there: measure "
        "neighbours, then loops in rounds, many at a time.")] = False
    jobs: Annotated[int | None, typer.Option(
        "--jobs", rich_help_panel=BATCH_GROUP, min=1, max=1024, help="With --batch, processes that measure, each with "
        "a board of its own.", show_default="processors of this machine")] = None
    scheduler: Annotated[str | None, typer.Option(
        "--scheduler", rich_help_panel=BATCH_GROUP, help="With --batch, measure on the workers of a Dask cluster: "
        "tcp://HOST:PORT; they see --out by the same path.", show_default=False)] = None

    @property
    def wanted(self) -> bool:
        """Whether the frames are measured all at once."""
        return self.batch or self.scheduler is not None

    @contextmanager
    def crew(self, out: Path, board: str, run: SurveyRun) -> Iterator[Crew | None]:
        """Those who measure; None for this process alone.

        Args:
            out: folder of the survey.
            board: kind of board.
            run: what was asked for.
        """
        jobs = self.jobs or processors()
        if not self.wanted or (self.scheduler is None and jobs == 1):
            yield None
            return
        bench = Bench(str(real_path(out / JOURNAL).parent), board, run.size, run.window, run.sigma)
        made: Crew = Processes(bench, jobs) if self.scheduler is None else Cluster(bench, self.scheduler)
        with made:
            notes.print(f"batch: measured by {made.name}")
            yield made
