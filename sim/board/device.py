"""The Verilated board from Python: whole frames and job lists per call, never Python per clock."""

from __future__ import annotations

import ctypes
from collections.abc import Iterable, Sequence
from pathlib import Path
from types import TracebackType
from typing import Self

import numpy as np
import numpy.typing as npt

from golden.correlate import Job, Result, Status
from golden.params import CONFIGS, Config
from sim.board.build import build
from sim.registers.map import address, fields, word

Image = npt.NDArray[np.uint8]
Beats = npt.NDArray[np.uint16]
"""Video beats: grey | start of frame << 8 | end of line << 9."""

FRAME_CLOCKS = 8
"""Clocks allowed per pixel of a frame before a capture counts as lost."""
SLACK = 100_000
"""Clocks allowed for anything besides."""
_TIMEOUT = -1


class DeviceError(RuntimeError):
    """The board did not do what it was asked to."""


class DeviceTimeout(DeviceError):
    """The board did not finish within the clocks allowed."""


def _library(path: Path) -> ctypes.CDLL:
    lib = ctypes.CDLL(str(path))
    p, i, u, n, t = ctypes.c_void_p, ctypes.c_int, ctypes.c_uint32, ctypes.c_int64, ctypes.c_uint64
    signatures: dict[str, tuple[object, list[object]]] = {
        "new": (p, []), "free": (None, [p]), "clocks": (t, [p]), "irq": (i, [p]), "stuck": (i, [p]),
        "trace": (i, [p, ctypes.c_char_p]), "tick": (None, [p, t]), "reset": (None, [p]), "write": (None, [p, u, u]),
        "read": (u, [p, u]), "set_filter": (i, [p, p, p, i, i, i, t]), "play": (None, [p, i, p, t, u, t]),
        "play_frame": (None, [p, i, p, i, i, u, t]), "finish_playing": (i, [p, t]), "arm": (i, [p, i, i]),
        "disarm": (None, [p, i]), "wait_captured": (i, [p, u, t]), "submit": (None, [p, p, n]),
        "collect": (i, [p, p, n, t]), "outstanding": (n, [p]), "pause_surface": (None, [p, u, t]),
        "surface": (i, [p, p, n, t]), "surface_waiting": (n, [p]), "peek": (None, [p, u, p, n]),
    }
    for name, (result, arguments) in signatures.items():
        function = getattr(lib, f"slog_{name}")
        function.restype, function.argtypes = result, arguments
    return lib


def frame_beats(frame: Image) -> Beats:
    """The beats of one good frame, uint8 (height, width), as a flat array."""
    beats = frame.astype(np.uint16)
    beats[:, -1] |= 1 << 9
    beats[0, 0] |= 1 << 8
    return beats.reshape(-1)


class Device:
    """One simulated board.

    Args:
        config: configuration or its name.
        trace: file for a wave dump (a slower build); None for none.

    Raises:
        sim.build.BuildError: if the board cannot be built.
    """

    def __init__(self, config: Config | str = "full", trace: Path | None = None) -> None:
        self.config = CONFIGS[config] if isinstance(config, str) else config
        if CONFIGS.get(self.config.name) != self.config:
            raise ValueError(f"{self.config.name!r} is not a configuration the RTL is generated for")
        self._lib = _library(build(self.config.name, trace is not None))
        self._board: int | None = self._lib.slog_new()
        self.size = (self.config.max_width, self.config.max_height)
        if trace is not None:
            self._lib.slog_trace(self._board, str(trace).encode())
        self.reset()
        self._check_build()

    def close(self) -> None:
        """Free the simulation and finish its wave dump."""
        if self._board is not None:
            self._lib.slog_free(self._board)
            self._board = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()

    # ------------------------------------------------------------------------------------------------------ registers
    def read(self, field: str) -> int:
        """A register field by path, such as `slot_status.valid`."""
        return fields()[field].unpack(self._register(fields()[field].address))

    def write(self, register: str, **values: int) -> None:
        """Write a register; fields not named become 0."""
        self._lib.slog_write(self._board, address(register), word(register, **values))
        self._check("register write")

    def _register(self, where: int) -> int:
        value: int = self._lib.slog_read(self._board, where)
        self._check("register read")
        return value

    @property
    def clocks(self) -> int:
        """Clocks since the simulation began."""
        return int(self._lib.slog_clocks(self._board))

    @property
    def irq(self) -> bool:
        """The interrupt output."""
        return bool(self._lib.slog_irq(self._board))

    def tick(self, clocks: int) -> None:
        """Let time pass."""
        self._lib.slog_tick(self._board, clocks)

    def reset(self) -> None:
        """Reset the board and forget all that is queued. Slots become invalid; coefficients 0; size the largest."""
        self._lib.slog_reset(self._board)
        self.size = (self.config.max_width, self.config.max_height)
        self._check("reset")

    def counters(self) -> dict[str, int]:
        """The board's counters, each modulo 2**32, by register name."""
        names = [name for name in fields() if name.startswith("counter.")]
        return {name.removeprefix("counter.").removesuffix(".value"): self.read(name) for name in names}

    # --------------------------------------------------------------------------------------------------------- frames
    def set_filter(self, g: Sequence[int] | npt.NDArray[np.integer], g2: Sequence[int] | npt.NDArray[np.integer],
                   size: tuple[int, int] | None = None) -> None:
        """Change coefficients and, if given, the image size (width, height); waits until frames under way are through.

        Args:
            g: smoothing kernel, centre first: `config.coefs` signed integers of 18 bits.
            g2: its second derivative.
            size: a changed size makes every slot invalid.

        Raises:
            DeviceError: if the size is outside the board's limits.
            DeviceTimeout: if a frame never ends.
        """
        kernels = [np.ascontiguousarray(k, np.int32) for k in (g, g2)]
        if any(len(k) != self.config.coefs for k in kernels):
            raise ValueError(f"kernels need {self.config.coefs} coefficients")
        width, height = size or self.size
        code = self._lib.slog_set_filter(self._board, kernels[0].ctypes.data, kernels[1].ctypes.data, self.config.coefs,
                                         width, height, self._frame_clocks())
        self._check("filter change", code)
        if self.read("filter.size_error"):
            raise DeviceError(f"the board refuses images of {width}x{height}")
        self.size = (width, height)

    def arm(self, slot: int, camera: int = 0) -> None:
        """Ask for the camera's next frame to go to the slot.

        Raises:
            DeviceError: if the board refuses.
        """
        taken = self._lib.slog_arm(self._board, camera, slot)
        self._check("capture request")
        if not taken:
            raise DeviceError(f"the board refuses to capture camera {camera} into slot {slot}")

    def disarm(self, camera: int = 0) -> None:
        """Withdraw the camera's request."""
        self._lib.slog_disarm(self._board, camera)

    def play(self, frame: Image, camera: int = 0, pause: float = 0.0, seed: int = 1) -> None:
        """Queue a frame, uint8 (height, width), on a camera; it plays while other calls run the clock.

        Args:
            pause: chance that a pixel is held back in a clock.
            seed: of the pauses.
        """
        pixels = np.ascontiguousarray(frame, np.uint8)
        self._lib.slog_play_frame(self._board, camera, pixels.ctypes.data, pixels.shape[1], pixels.shape[0],
                                  round(pause * 1000), seed)

    def play_beats(self, beats: Beats, camera: int = 0, pause: float = 0.0, seed: int = 1) -> None:
        """Queue raw beats, good or bad frames alike."""
        flat = np.ascontiguousarray(beats, np.uint16)
        self._lib.slog_play(self._board, camera, flat.ctypes.data, len(flat), round(pause * 1000), seed)

    def finish_playing(self) -> None:
        """Run until the cameras' queued beats are taken.

        Raises:
            DeviceTimeout: if the board stops taking them.
        """
        self._check("video", self._lib.slog_finish_playing(self._board, 8 * self._frame_clocks()))

    def wait_captured(self, *cameras: int) -> None:
        """Run until the cameras' requests are fulfilled.

        Raises:
            DeviceTimeout: if a request stays: no good frame came.
        """
        mask = sum(1 << c for c in set(cameras))
        self._check("capture", self._lib.slog_wait_captured(self._board, mask, self._frame_clocks()))

    def capture(self, slots: dict[int, int], frames: dict[int, Image], pause: float = 0.0, seed: int = 1) -> None:
        """Send one frame through each camera named, all at once, into its slot; both arguments by camera.

        Raises:
            DeviceError: if the board refuses, or drops a frame.
        """
        drops = {c: self.read(f"counter.drops[{c}].value") for c in frames}
        for camera, slot in slots.items():
            self.arm(slot, camera)
        for camera, frame in frames.items():
            self.play(frame, camera, pause, seed + camera)
        self.finish_playing()
        lost = [c for c in frames if self.read(f"counter.drops[{c}].value") != drops[c]]
        if not lost:
            self.wait_captured(*slots)
            return
        for camera in slots:
            self.disarm(camera)
        raise DeviceError(f"the board dropped the frame of camera {', '.join(map(str, lost))}")

    def plane(self, slot: int) -> Image:
        """The slot's sign bits, uint8 0/1 (height, width) of the present size."""
        c = self.config
        width, height = self.size
        pieces = -(-c.group_bits // 32)
        data = np.zeros(height * c.words_per_row * pieces, np.uint32)
        self._lib.slog_peek(self._board, slot * c.slot_words, data.ctypes.data, len(data))
        self._check("plane read-back")
        bits = np.unpackbits(data.view(np.uint8).reshape(-1, 4), axis=1, bitorder="little")
        bits = bits.reshape(height, c.words_per_row, pieces * 32)[:, :, :c.group_bits]
        return np.ascontiguousarray(bits.reshape(height, -1)[:, :width])

    # ----------------------------------------------------------------------------------------------------------- jobs
    def submit(self, jobs: Iterable[Job]) -> None:
        """Queue jobs; what the board has no room for waits on this side."""
        self._submit([(job, (1, 1), (0, 0)) for job in jobs])

    def submit_grid(self, job: Job, count: tuple[int, int], step: tuple[int, int]) -> None:
        """Queue a grid of jobs by one command: counts and steps (across, down)."""
        self._submit([(job, count, step)])

    def _submit(self, commands: list[tuple[Job, tuple[int, int], tuple[int, int]]]) -> None:
        rows = np.array([
            [j.tag, j.surface, j.tpl_slot, j.tpl_x, j.tpl_y, j.width, j.height, j.search_slot, j.search_x, j.search_y,
             j.offsets_x, j.offsets_y, *count, *step] for j, count, step in commands], np.int32)
        self._lib.slog_submit(self._board, rows.ctypes.data, len(rows))
        self._check("job submission")

    @property
    def outstanding(self) -> int:
        """Results not yet collected."""
        return int(self._lib.slog_outstanding(self._board))

    def collect(self, count: int) -> list[Result]:
        """The next `count` results in job order; waits for them.

        Raises:
            DeviceTimeout: if they do not come.
        """
        rows = np.zeros((count, 14), np.int32)
        # The longest job: a pass of max_window steps for every pitch offsets.
        c = self.config
        longest = c.max_width * c.max_height * c.max_window // c.pitch
        self._check(f"collecting {count} results",
                    self._lib.slog_collect(self._board, rows.ctypes.data, count, 2 * longest + SLACK))
        results = []
        for row in rows.tolist():
            tag, status, x, y, score, *around, runner_up = row
            n0, n1, n2, n3, n4, n5, n6, n7 = around
            results.append(Result(tag, Status(status), x, y, score, (n0, n1, n2, n3, n4, n5, n6, n7), runner_up))
        return results

    def run(self, jobs: Sequence[Job]) -> list[Result]:
        """Submit jobs and collect their results."""
        self.submit(jobs)
        return self.collect(len(jobs))

    def surface(self, count: int) -> npt.NDArray[np.int32]:
        """The next `count` scores of the surface stream.

        Raises:
            DeviceError: if they do not come, or first and last marks are wrong.
        """
        scores = np.zeros(count, np.uint16)
        self._check("surface", self._lib.slog_surface(self._board, scores.ctypes.data, count, 10 * SLACK))
        return scores.astype(np.int32)

    @property
    def surface_waiting(self) -> int:
        """Scores that have streamed out and were not taken by `surface`."""
        return int(self._lib.slog_surface_waiting(self._board))

    def pause_surface(self, pause: float, seed: int = 1) -> None:
        """Make the surface's receiver unwilling in this share of the clocks."""
        self._lib.slog_pause_surface(self._board, round(pause * 1000), seed)

    # ---------------------------------------------------------------------------------------------------------- checks
    def _frame_clocks(self) -> int:
        return FRAME_CLOCKS * self.size[0] * self.size[1] + SLACK

    def _check(self, what: str, code: int = 0) -> None:
        if self._lib.slog_stuck(self._board):
            raise DeviceTimeout(f"{what}: the register bus does not answer (clock {self.clocks})")
        if code == _TIMEOUT:
            raise DeviceTimeout(f"{what}: no progress up to clock {self.clocks}; {self._state()}")
        if code:
            raise DeviceError(f"{what}: broken stream marks at clock {self.clocks}")

    def _state(self) -> str:
        names = ("filter.busy", "slot_status.valid", "slot_status.armed", "slot_status.writing", "job.status.waiting",
                 "job.status.busy", "result.pop.waiting")
        return ", ".join(f"{name} {self.read(name):#x}" for name in names)

    def _check_build(self) -> None:
        """The library must be the board that the caller takes it for."""
        c = self.config
        want = {"id.value": int.from_bytes(b"SLOG"), "build_image.max_width": c.max_width,
                "build_image.max_height": c.max_height, "build_window.group_bits": c.group_bits,
                "build_window.words_per_row": c.words_per_row, "build_board.slots": c.slots,
                "build_board.cameras": c.cameras, "build_filter.radius": c.radius}
        wrong = [name for name, value in want.items() if self.read(name) != value]
        if wrong:
            raise DeviceError(f"the board is not {c.name!r}: {', '.join(wrong)} differ")
