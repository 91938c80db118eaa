# SPDX-License-Identifier: Apache-2.0
"""Hours at sea in minutes: `signum hold` on a looped video stream from another process; `make stream`.

    python -m tests.stream [--minutes 10] [--width 640 --height 480]

A camera process sends H.264 in RTP, 30 frames a second, over the loopback interface; `signum hold` measures it on the
golden board and tells an autopilot by MAVLink, which gives its time by TIMESYNC. Bars: the memory does not grow after
the first minute (fifth, of a shorter run); a frame is at most two periods old when it is taken, and told of later by no
more than the work on it; 8 messages a second or more; the deltas add up to the last reading within 1 mm. What the
command's threads waited for a processor, which other programs had, is added to the bounds of age.
"""

from __future__ import annotations

import argparse
import csv
import math
import os
import re
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from threading import Event, Thread
from typing import Any

import cv2
import numpy as np

from signum.common.arrays import Floats, Image

from .applications.mavlink.ends import Receiver, receiver
from .sources.cameras import HOST, encoded, free_port, packets

RATE = 30
LOOP = 240
"""Frames of the film, which begins where it ends."""
SWAY = 0.05, 0.04
"""Of the view, parts of the picture's width and height."""
LEAST_HZ, MOST_MM, FOCAL = 8.0, 1.0, 700.0
MOST_BLIND = 1.0
"""Frames of 1,000 that may be without a reading: behind a pause of the machine the view is elsewhere."""
GROWTH = 1 << 20, 3 << 20
"""Bytes that count as no growth, the allocator's own steps: after a minute, and after less."""
POLL_S = 0.1
"""How often memory and waiting are looked at, seconds."""
PAGE = os.sysconf("SC_PAGE_SIZE")


def film(size: tuple[int, int]) -> Iterator[Image]:
    """A camera that sways over a texture, with noise; the last frame is followed by the first."""
    chance = np.random.default_rng(5)
    reach = [2 + math.ceil(part * side) for part, side in zip(SWAY, size, strict=True)]
    shape = size[1] + 2 * reach[1], size[0] + 2 * reach[0]
    fine, coarse = (cv2.GaussianBlur(chance.normal(64, 60 * s, shape), (0, 0), s) for s in (2.0, 6.0))
    for k in range(LOOP):
        turn = 2 * math.pi * k / LOOP
        x, y = reach[0] * (1 + 0.9 * math.sin(turn)), reach[1] * (1 + 0.9 * math.sin(2 * turn))
        view = cv2.warpAffine(fine + coarse, np.array([[1.0, 0, -x], [0, 1.0, -y]]), size)
        view = view + chance.normal(0, 4, size[::-1])
        yield np.repeat(np.clip(view, 0, 255).astype(np.uint8)[:, :, None], 3, 2)


def camera(port: int, size: tuple[int, int]) -> None:
    """Send the film to a port, again and again, until the process is ended."""
    units = encoded(list(film(size)), every=RATE, rate=RATE)
    number, stamp, sent = 0, 0, 0
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
        print("ready", flush=True)
        start = time.monotonic()
        while True:
            for parts in packets(units, RATE, number, stamp):
                time.sleep(max(0.0, start + sent / RATE - time.monotonic()))
                for part in parts:
                    out.sendto(part, (HOST, port))
                number, sent = (number + len(parts)) % 65536, sent + 1
            stamp = (stamp + LOOP * 90_000 // RATE) % (1 << 32)


@dataclass
class Heard:
    """What the autopilot has been told: time of arrival, of the frame (both monotonic, seconds) and the message."""

    deltas: list[tuple[float, float, Any]] = field(default_factory=list)

    def listen(self, stop: Event, other: Receiver) -> None:
        """Take in messages, and answer questions for the time with that of this machine."""
        while not stop.is_set():
            message = other.link.recv_match(blocking=True, timeout=0.1)
            now = time.monotonic()
            if message is None:
                continue
            if message.get_type() == "VISION_POSITION_DELTA":
                self.deltas.append((now, 1e-6 * message.time_usec, message))
            elif message.get_type() == "TIMESYNC" and message.tc1 == 0:
                other.link.mav.timesync_send(round(1e9 * now), message.ts1)

    def sum(self) -> Floats:
        """The deltas of position, each turned by the heading at its beginning, added up: forward, right, metres."""
        heading, total = 0.0, np.zeros(2)
        for _, _, m in self.deltas:
            c, s = math.cos(heading), math.sin(heading)
            dx, dy, _ = m.position_delta
            total += c * dx - s * dy, s * dx + c * dy
            heading += m.angle_delta[2]
        return total


@dataclass(frozen=True)
class Run:
    """What a run gave.

    Attributes:
        memory: (n, 2) seconds since the start and resident bytes.
        waited_s: longest that the machine kept the command waiting for a processor within two looks: the two threads
            that waited longest, one behind the other, as a frame passes through reader and measurement.
        heard: by the autopilot.
        rows: of `hold.csv`.
        said: by the command.
        cpu_s: that the command took.
    """

    memory: Floats
    waited_s: float
    heard: Heard
    rows: list[dict[str, str]]
    said: str
    cpu_s: float

    def judge(self) -> list[tuple[str, float, float, bool]]:
        """What, measured, its bound and whether it is kept."""
        times, sizes = self.memory.T
        warm = min(60.0, times[-1] / 5)
        most = GROWTH[int(warm < 60.0)]
        early, late = (part.max() for part in np.array_split(sizes[times > warm], 8)[::7])
        arrived = np.array([now for now, _, _ in self.heard.deltas])
        ages = 1e3 * np.array([now - frame for now, frame, _ in self.heard.deltas])
        period = 1e3 / RATE
        taken = float(re.findall(r"at most (\d+) ms old", self.said)[0])
        valid = [r for r in self.rows if r["x_m"]]
        last = np.array([float(valid[-1]["x_m"]), float(valid[-1]["y_m"])])
        times_s = np.array([float(r["time_s"]) for r in self.rows])
        work, waited = 1e3 * self.cpu_s / len(self.rows), 1e3 * self.waited_s
        return [
            ("growth of memory, MB", (late - early) / 1e6, most / 1e6, late - early <= most),
            ("age of a frame when taken, worst, ms", taken, 2 * period + waited, taken <= 2 * period + waited),
            ("age of a frame when told of, median, ms", float(np.median(ages)), 2 * period + work,
             float(np.median(ages)) <= 2 * period + work),
            ("age of a frame when told of, 99 %, ms", float(np.quantile(ages, 0.99)), 2 * period + work + waited,
             float(np.quantile(ages, 0.99)) <= 2 * period + work + waited),
            ("messages a second", rate := (len(arrived) - 1) / (arrived[-1] - arrived[0]), LEAST_HZ, rate >= LEAST_HZ),
            ("longest pause between messages, s", pause := float(np.diff(arrived).max()), 0.5 + self.waited_s,
             pause <= 0.5 + self.waited_s),
            ("sum of deltas beside the last reading, mm", off := 1e3 * float(np.abs(self.heard.sum() - last).max()),
             MOST_MM, off <= MOST_MM),
            ("frames without a reading, of 1,000", blind := 1e3 * (1 - len(valid) / len(self.rows)), MOST_BLIND,
             blind <= MOST_BLIND),
            ("time by the frames less that by our clock, s", drift := abs(float(times_s[-1]) - self.memory[-1, 0]), 2.0,
             drift <= 2.0),
        ]


def run(seconds: float, size: tuple[int, int], out: Path, *options: str) -> Run:
    """Run the camera, `signum hold` and the autopilot for a time."""
    port, heard = free_port(), Heard()
    focal = FOCAL * size[0] / 640
    command = [sys.executable, "-m", "signum.commands.cli", "hold", "--source", f"udp://{HOST}:{port}", "--range", "1",
               "--focal", f"{focal:g}", "--out", str(out), *options]
    with receiver() as other, _process([sys.executable, "-m", "tests.stream", "--send", str(port), "--width",
                                        str(size[0]), "--height", str(size[1])]) as sender:
        assert sender.stdout is not None and sender.stdout.readline() == "ready\n"
        stop = Event()
        listener = Thread(target=heard.listen, args=(stop, other))
        listener.start()
        try:
            with _process([*command, "--mavlink", other.address]) as hold:
                memory, waited, cpu = _watch(hold, heard, seconds)
                hold.send_signal(signal.SIGTERM)  # a job in the background ignores SIGINT
                _, said = hold.communicate(timeout=20)
            time.sleep(0.3)
        finally:
            stop.set()
            listener.join()
    assert hold.returncode == 130, said
    with (out / "hold.csv").open() as table:
        return Run(memory, waited, heard, list(csv.DictReader(table)), said, cpu)


@contextmanager
def _process(command: list[str]) -> Iterator[subprocess.Popen[str]]:
    """A process of Python that is ended with the `with`."""
    places = os.pathsep.join(filter(None, sys.path))
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                          env={**os.environ, "PYTHONPATH": places}) as one:
        go_first(one.pid)
        try:
            yield one
        finally:
            one.kill()


def _watch(hold: subprocess.Popen[str], heard: Heard, seconds: float) -> tuple[Floats, float, float]:
    """Memory from the first message on, for a time; the longest wait for a processor within two looks; and processor
    time."""
    end = time.monotonic() + 30
    while not heard.deltas and time.monotonic() < end:
        assert hold.poll() is None, hold.communicate()[1]
        time.sleep(0.05)
    assert heard.deltas, "no message in 30 s"
    start, before = time.monotonic(), _cpu(hold.pid)
    memory, waited = [], []
    while (now := time.monotonic() - start) < seconds:
        assert hold.poll() is None, hold.communicate()[1]
        memory.append((now, int(Path(f"/proc/{hold.pid}/statm").read_text().split()[1]) * PAGE))
        waited.append(_waited(hold.pid))
        time.sleep(POLL_S)
    longest = max(sum(sorted(b[task] - a.get(task, 0.0) for task in b)[-2:])
                  for a, b in zip(waited, waited[2:], strict=False))
    return np.array(memory, np.float64), longest, _cpu(hold.pid) - before


def _waited(pid: int) -> dict[str, float]:
    """Time that each thread of a process has waited for a processor so far, seconds."""
    waited = {}
    for task in Path(f"/proc/{pid}/task").glob("*/schedstat"):
        with suppress(OSError):  # of a thread that has ended
            waited[task.parent.name] = 1e-9 * int(task.read_text().split()[1])
    return waited


def go_first(pid: int) -> None:
    """Let a process go before others, where that is allowed: other programs on the machine are no part of the run."""
    with suppress(PermissionError):
        os.setpriority(os.PRIO_PROCESS, pid, -10)


def _cpu(pid: int) -> float:
    """Processor time of a process, seconds."""
    parts = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(parts[11]) + int(parts[12])) / os.sysconf("SC_CLK_TCK")


def main() -> int:
    """Run and print; returns 0 if all bars are kept."""
    parser = argparse.ArgumentParser(description="signum hold on a looped stream from another process.")
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--width", type=int, default=640)
    parser.add_argument("--height", type=int, default=480)
    parser.add_argument("--send", type=int, default=0, help="be the camera: send to this port")
    options = parser.parse_args()
    size = options.width, options.height
    if options.send:
        camera(options.send, size)
    with tempfile.TemporaryDirectory() as name:
        done = run(60 * options.minutes, size, Path(name) / "hold")
    for minute in range(math.ceil(options.minutes) + 1):
        at = min(int(np.searchsorted(done.memory[:, 0], 60 * minute)), len(done.memory) - 1)
        print(f"minute {done.memory[at, 0] / 60:.1f}: {done.memory[at, 1] / 1e6:.1f} MB")
    print(f"{len(done.rows)} frames measured, {1e3 * done.cpu_s / len(done.rows):.1f} ms of processor time each; "
          f"{re.findall('[0-9,]+ frames skipped', done.said)[0]}")
    bars = done.judge()
    for what, measured, bound, kept in bars:
        print(f"{what}: {measured:.2f}, bound {bound:.2f}" + ("" if kept else "  MISSED"))
    return 0 if all(kept for *_, kept in bars) else 1


if __name__ == "__main__":
    sys.exit(main())
