# SPDX-License-Identifier: Apache-2.0
"""Measures speeds on this machine and writes `out/bench.json`.

`python -m sim.speed [--out FILE]`. Seconds are of processor time, of one core: other load on the machine has little
influence, but ratios within one run are more reliable than the figures.
"""

from __future__ import annotations

import argparse
import json
import os
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from golden.correlate import run as golden_run
from golden.log import kernels, sign
from golden.params import CONFIGS, Config
from sim.board.device import Device
from sim.speed import workload
from sim.speed.dense import dense_against_opencv, dense_pass
from sim.testbench.runner import AXI_PORTS, simulate
from sim.toolchain import ROOT, SYNTHESIS

FIGURES = ROOT / "out" / "bench.json"
REPORT = SYNTHESIS / "report.json"
SIZES = ((384, 288), (640, 480))
QUEUE = 40
"""Searches in the utilisation queue."""


def fastest(work: Callable[[], object], seconds: float = 1.0, least: int = 3) -> float:
    """Least processor time of `work` in seconds, over at least `least` runs and about `seconds` altogether."""
    work()
    times: list[float] = []
    while len(times) < least or sum(times) < seconds:
        begun = time.process_time()
        work()
        times.append(time.process_time() - begun)
    return min(times)


def device(config: Config, size: tuple[int, int]) -> Device:
    """A Verilated board with the workload's filter at `size`."""
    board = Device(config)
    board.set_filter(*kernels(workload.SIGMA, config.radius), size)
    return board


def clock_rates(config: Config) -> dict[str, Any]:
    """Clocks per second of the cocotb bench and of the Verilated board on the same workload, results compared."""
    out = FIGURES.parent / "bench-cocotb.json"
    out.parent.mkdir(parents=True, exist_ok=True)
    out.unlink(missing_ok=True)
    simulate("slog_board", "cocotb_tests.bench_board", config=config.name, ports=AXI_PORTS,
             env={"SLOG_BENCH_CONFIG": config.name, "SLOG_BENCH_OUT": str(out)})
    slow = json.loads(out.read_text())
    out.unlink()
    results: list[list[int]] = []
    rates = []
    for _ in range(5):
        with device(config, workload.SIZE) as board:
            first, begun = board.clocks, time.process_time()
            for slot, frame in enumerate(workload.frames()):
                board.capture({0: slot}, {0: frame})
            results = [[r.best_x, r.best_y, r.score] for r in board.run(workload.jobs())]
            rates.append((board.clocks - first) / (time.process_time() - begun))
    if results != slow["results"]:
        raise SystemExit(f"cocotb and Verilated boards disagree: {slow['results']} and {results}")
    cocotb_rate = slow["clocks"] / slow["seconds"]
    return {"cocotb_clocks_per_s": round(cocotb_rate), "verilated_clocks_per_s": round(max(rates)),
            "ratio": round(max(rates) / cocotb_rate, 1), "cocotb_clocks": slow["clocks"]}


def frame_rates(config: Config) -> dict[str, Any]:
    """Frames per second from picture to sign plane in a slot, and the clocks of one on the board."""
    found = {}
    for width, height in SIZES:
        frame, _ = workload.pair(width, height)
        with device(config, (width, height)) as board:
            board.capture({0: 0}, {0: frame})
            first = board.clocks
            board.capture({0: 0}, {0: frame})
            clocks = board.clocks - first
            verilated = fastest(lambda: board.capture({0: 0}, {0: frame}))  # noqa: B023
            if not np.array_equal(board.plane(0), sign(frame, workload.SIGMA, config.radius)):
                raise SystemExit(f"Verilated and golden planes of {width}x{height} differ")
        golden = fastest(lambda: sign(frame, workload.SIGMA, config.radius))  # noqa: B023
        found[f"{width}x{height}"] = {
            "verilated_frames_per_s": round(1 / verilated, 2), "verilated_s_per_frame": round(verilated, 4),
            "golden_frames_per_s": round(1 / golden, 1), "clocks_per_frame": clocks}
    return found


def score_share(config: Config) -> dict[str, Any]:
    """Share of clocks that yield a score over a queue of searches, submission and loading included."""
    size = SIZES[-1]
    first_frame, second = workload.pair(*size)
    with device(config, size) as board:
        board.capture({0: 0}, {0: first_frame})
        board.capture({0: 1}, {0: second})
        jobs = [workload.search_job(size, tag) for tag in range(QUEUE)]
        scores, first, begun = board.counters()["scores"], board.clocks, time.process_time()
        results = board.run(jobs)
        seconds, clocks = time.process_time() - begun, board.clocks - first
        scores = board.counters()["scores"] - scores
    planes = {k: sign(f, workload.SIGMA, config.radius) for k, f in enumerate((first_frame, second))}
    if results[0] != golden_run(jobs[0], planes, config, size):
        raise SystemExit("Verilated and golden results differ")
    golden = fastest(lambda: golden_run(jobs[0], planes, config, size))
    return {"searches": QUEUE, "scores": scores, "clocks": clocks, "share": round(scores / clocks, 4),
            "verilated_searches_per_s": round(QUEUE / seconds, 1), "golden_searches_per_s": round(1 / golden, 1)}


def against_opencv(share: float) -> dict[str, Any]:
    """Window scores per second: hardware at its routed clock, cv2.matchTemplate on one core, the same search."""
    cv2.setNumThreads(1)
    plane = sign(workload.texture(128, 128), workload.SIGMA, CONFIGS["full"].radius) * np.uint8(255)
    template = plane[32:96, 32:96].copy()
    found: dict[str, Any] = {}
    for name, method in (("TM_CCOEFF_NORMED", cv2.TM_CCOEFF_NORMED), ("TM_CCORR", cv2.TM_CCORR)):
        seconds = fastest(lambda: cv2.matchTemplate(plane, template, method))  # noqa: B023
        found[name] = {"searches_per_s": round(1 / seconds), "scores_per_s": round(65 * 65 / seconds)}
    if REPORT.exists():
        mhz = json.loads(REPORT.read_text())["fmax_mhz"]
        rate = mhz * 1e6 * share
        found["hardware"] = {"fmax_mhz": mhz, "searches_per_s": round(rate / 65**2), "scores_per_s": round(rate)}
        for name in ("TM_CCOEFF_NORMED", "TM_CCORR"):
            found[f"hardware_over_{name}"] = round(rate / found[name]["scores_per_s"], 1)
    else:
        found["hardware"] = "unknown: run `make synth` first"
    return found


def main(argv: Sequence[str] | None = None) -> int:
    """Measure, print and write; returns the exit status."""
    parser = argparse.ArgumentParser(description="Speeds of the board, of its simulators and of OpenCV")
    parser.add_argument("--out", type=Path, default=FIGURES)
    args = parser.parse_args(argv)
    config = CONFIGS["full"]
    figures: dict[str, Any] = {"machine": {"cores": os.cpu_count(), "load": os.getloadavg()[0]}}
    measures: list[tuple[str, Callable[[], dict[str, Any]]]] = [
        ("frames", lambda: frame_rates(config)), ("utilisation", lambda: score_share(config)),
        ("opencv", lambda: against_opencv(figures["utilisation"]["share"])),
        ("clock_rate", lambda: clock_rates(config)), ("dense", lambda: dense_pass(CONFIGS["dense"])),
        ("dense_opencv", dense_against_opencv)]
    for name, measure in measures:
        figures[name] = measure()
        print(f"{name}: {json.dumps(figures[name], indent=2)}", flush=True)
    args.out.parent.mkdir(parents=True, exist_ok=True)
    args.out.write_text(json.dumps(figures, indent=2) + "\n")
    print(args.out)
    return 0
