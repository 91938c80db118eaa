# SPDX-License-Identifier: Apache-2.0
"""Who measures the registrations of a recorded survey: processes of this machine, or the workers of a Dask cluster.

Each worker has a board of its own and reads the stored pictures of a survey's folder, each of them once as long as its
memory for them lasts. What it is asked is a list of questions (`journal.Key`), what it answers the registrations: the
same whoever measures them. A worker that is lost costs what it was at work on, which others then do.
"""

from __future__ import annotations

import os
import re
import signal
import threading
from abc import ABC, abstractmethod
from collections import OrderedDict
from collections.abc import Iterator, Sequence
from concurrent.futures import CancelledError, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack
from dataclasses import dataclass
from multiprocessing import connection, get_context, parent_process
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import Any, Self

import cv2

from signum.applications.mosaic.journal import Key
from signum.boards import open_board
from signum.common.errors import SignumError, lacking
from signum.common.files import decode_png, own_bytes
from signum.frames.fit import Fit
from signum.geometry.similarity import Similarity
from signum.measure.measurer import Measurer
from signum.measure.register import Registrar
from signum.measure.registration import Prepared, Registration

SHARE = 12
"""Questions handed to a worker at a time at most."""
HELD_BYTES = 128_000_000
"""Memory of a worker for the frames it has read."""
TRIES = 5
"""Times that a share of the questions is handed out before it is given up, as its workers are lost each time."""
ADDRESS = re.compile(r"(tcp|tls)://([\w.-]+|\[[0-9a-fA-F:.]+\]):\d{1,5}")
"""Of a scheduler."""
BEAT_S = 0.3
"""How long a command waits for answers before it looks whether it is to stop, seconds."""
Answers = list[Registration]


@dataclass(frozen=True)
class Bench:
    """What a worker needs to know.

    Attributes:
        frames: whole path of the folder with the stored pictures.
        board: its kind.
        size: width and height of the frames, pixels.
        window, sigma: of the registration.
    """

    frames: str
    board: str
    size: tuple[int, int]
    window: int
    sigma: float


class _Worker:
    """A board, a registrar on it, and the frames read last."""

    def __init__(self, bench: Bench) -> None:
        cv2.setNumThreads(1)
        self._open = ExitStack()
        board = self._open.enter_context(open_board(bench.board))
        fit = Fit.to(bench.size, board.config, bench.window)
        self._registrar = Registrar.on(lambda size, sigma: Measurer(board, size, sigma), fit, bench.window, bench.sigma)
        self._bench, self._held = bench, OrderedDict[int, Prepared]()

    def close(self) -> None:
        self._open.close()

    def answer(self, key: Key) -> Registration:
        a, b, guess, reach = key
        like = None if guess is None else Similarity(complex(guess[0], guess[1]), complex(guess[2], guess[3]))
        return self._registrar.register(self._frame(a), self._frame(b), like, reach)

    def _frame(self, number: int) -> Prepared:
        found = self._held.pop(number, None)
        if found is None:
            path = Path(self._bench.frames) / f"{number:06d}.png"
            try:
                picture = decode_png(own_bytes(path))
            except OSError as error:
                raise SignumError(f"{path}: a worker cannot read it ({error.strerror}): --out must be in a folder that "
                                  "all workers see by the same path") from error
            if picture is None:
                raise SignumError(f"{path}: is damaged; call again, so that it is stored again")
            found = self._registrar.prepare(picture)
        self._held[number] = found
        while len(self._held) > max(2, HELD_BYTES // found.nbytes):
            self._held.popitem(last=False)
        return found


_local = threading.local()
"""Each thread of a worker process has a board of its own."""


def answer_all(bench: Bench, questions: Sequence[Key]) -> Answers:
    """Answer questions; called in a worker.

    Raises:
        SignumError: if a picture cannot be read.
    """
    if getattr(_local, "bench", None) != bench:
        if getattr(_local, "worker", None) is not None:
            _local.worker.close()
        _local.worker, _local.bench = _Worker(bench), bench
    return [_local.worker.answer(key) for key in questions]


class Crew(ABC):
    """Those who answer; let go at a `with`'s end.

    Attributes:
        size: how many there are.
        name: of them, in words.
    """

    size: int
    name: str

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def answers(self, shares: Sequence[Sequence[Key]]) -> Iterator[tuple[Sequence[Key], Answers]]:
        """The shares with their answers, in the order in which they are finished; at least once in `BEAT_S` something,
        if need be an empty share.

        Raises:
            SignumError: if a picture cannot be read, or workers are lost one after the other.
        """
        done: SimpleQueue[tuple[int, Any]] = SimpleQueue()
        handed: dict[int, Any] = {}
        tries = [0] * len(shares)

        def hand(number: int) -> None:
            tries[number] += 1
            handed[number] = future = self._submit(shares[number])
            future.add_done_callback(lambda finished: done.put((number, finished)))

        for number in range(len(shares)):
            hand(number)
        while handed:
            try:
                number, future = done.get(timeout=BEAT_S)
            except Empty:
                yield (), []
                continue
            try:
                found: Answers = future.result()
            except Exception as error:
                if not self._lost(error):
                    raise
                if tries[number] == TRIES:
                    raise SignumError(f"{self.name}: the workers are lost one after the other; is there too little "
                                      "memory?") from error
                hand(number)
                continue
            del handed[number]
            yield shares[number], found

    @abstractmethod
    def _submit(self, share: Sequence[Key]) -> Any:
        """Hand out a share; returns its future."""

    @abstractmethod
    def _lost(self, error: Exception) -> bool:
        """Whether an error means that a worker was lost, rather than that it could not answer."""

    @abstractmethod
    def close(self) -> None:
        """Let the workers go, whatever they are at work on."""


class Processes(Crew):
    """Processes of this machine.

    Args:
        bench: what they need to know.
        count: how many.
    """

    def __init__(self, bench: Bench, count: int) -> None:
        self._bench, self.size = bench, count
        self.name = f"{count} processes"
        self._pool: ProcessPoolExecutor | None = None

    @property
    def pids(self) -> list[int]:
        """Of the processes."""
        return [] if self._pool is None else list(self._pool._processes)

    def _submit(self, share: Sequence[Key]) -> Any:
        for _ in range(TRIES):
            if self._pool is None:
                self._pool = ProcessPoolExecutor(self.size, get_context("spawn"), _begin)
            try:
                return self._pool.submit(answer_all, self._bench, share)
            except BrokenProcessPool:
                self.close()
        raise SignumError(f"{self.name}: cannot be begun; is there too little memory?")

    def _lost(self, error: Exception) -> bool:
        return isinstance(error, BrokenProcessPool)

    def close(self) -> None:
        """See `Crew`."""
        pool, self._pool = self._pool, None
        if pool is not None:
            processes = list((pool._processes or {}).values())
            pool.shutdown(wait=False, cancel_futures=True)
            for process in processes:
                process.terminate()
            for process in processes:
                process.join()


def _begin() -> None:
    """A process of the pool ends with the command that began it, and by nothing that is meant for that."""
    for number in (signal.SIGINT, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    parent = parent_process()
    if parent is not None:
        watched = parent.sentinel

        def follow() -> None:
            connection.wait([watched])
            os._exit(1)

        threading.Thread(target=follow, daemon=True).start()


class Cluster(Crew):
    """The workers of a Dask cluster, which see the survey's folder by the same path.

    Args:
        bench: what they need to know.
        address: of the scheduler, tcp://HOST:PORT.
        patience_s: how long to wait for the scheduler, and for a worker.

    Raises:
        SignumError: if the extra for it is not installed, or there is no scheduler or no worker.
    """

    def __init__(self, bench: Bench, address: str, patience_s: float = 20.0) -> None:
        if not ADDRESS.fullmatch(address):
            raise SignumError(f"--scheduler {address}: expected tcp://HOST:PORT")
        try:
            from distributed import Client
        except ModuleNotFoundError as error:
            raise lacking("cluster", error) from error
        self._bench = bench
        try:
            make: Any = Client  # whose constructor has no types
            self._client = make(address, timeout=patience_s, set_as_default=False)
            self._client.wait_for_workers(1, timeout=patience_s)
        except (OSError, TimeoutError, ValueError) as error:
            raise SignumError(f"--scheduler {address}: no Dask scheduler with workers answers there: start `dask "
                              "scheduler` and, on each machine, `dask worker tcp://HOST:PORT`") from error
        self.size = sum(self._client.nthreads().values())
        self.name = f"{self.size} workers of {address}"

    def _submit(self, share: Sequence[Key]) -> Any:
        return self._client.submit(answer_all, self._bench, share, pure=False)

    def _lost(self, error: Exception) -> bool:
        from distributed import KilledWorker

        if isinstance(error, CancelledError):
            raise SignumError("the Dask scheduler is gone; call again to go on") from error
        return isinstance(error, KilledWorker)

    def close(self) -> None:
        """See `Crew`."""
        if self._client.status != "closed":
            self._client.close(timeout=1)


def shared_out(questions: Sequence[Key], workers: int) -> list[Sequence[Key]]:
    """The questions in shares of neighbours, so that a worker reads few frames, and several shares for each worker."""
    ordered = sorted(questions, key=lambda key: (key[1], key[0]))
    step = max(1, min(SHARE, -(-len(ordered) // (4 * max(1, workers)))))
    return [ordered[k:k + step] for k in range(0, len(ordered), step)]


def processors() -> int:
    """How many processors this process may use."""
    return len(os.sched_getaffinity(0))
