# SPDX-License-Identifier: Apache-2.0
"""The surroundings of the board with the dense engine: as `host`, and passes and their maps."""

from __future__ import annotations

from collections.abc import Generator

from cocotb_tests.env.host import Host, Script
from golden.dense_job import DenseJob

Words = list[int]
"""The words of a map."""


class DenseHost(Host):
    """Registers, cameras and the sink of maps of a board with a dense engine."""

    STREAM = "map"

    def load(self, job: DenseJob, **raw: int) -> Script:
        """Write a pass' registers; `raw` has values that a job refuses: `window`, `offsets`."""
        one = job.search
        yield from self.write("dense.planes", left=job.left, right=job.right, window=raw.get("window", one.window),
                              check=int(job.check), live=int(job.live))
        yield from self.write("dense.search", offsets=raw.get("offsets", one.offsets), start=one.start)
        yield from self.write("dense.vertical", down=one.down, step_x=job.step[0], step_y=job.step[1])
        yield from self.write("dense.limits", most=job.most, margin=job.margin)

    def go(self) -> Script:
        """Start a pass."""
        yield from self.write("dense.run", go=1)

    def finished(self) -> Generator[None, None, int]:
        """Wait for the end of the pass; its status."""
        while (yield from self.read("dense.run.busy")):
            pass
        return (yield from self.read("dense.run.status"))

    def take_map(self) -> Words:
        """The words of the one map that has streamed out, whose marks are right."""
        marks = [(first, last) for _, first, last in self.streamed]
        assert marks == [(int(n == 0), int(n == len(marks) - 1)) for n in range(len(marks))], marks
        words = [word for word, _, _ in self.streamed]
        self.streamed.clear()
        return words
