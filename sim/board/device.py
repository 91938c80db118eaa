# SPDX-License-Identifier: Apache-2.0
"""The Verilated board from Python: whole frames and job lists per call, never Python per clock."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from golden.log import Image
from golden.params import CONFIGS, Config
from sim.board.build import build
from sim.board.driver import SLACK, DeviceError, DeviceTimeout, RegisterDriver
from sim.board.library import BOARD, MAP, STREAM_BROKEN, SURFACE, load
from sim.board.structs import Accesses

__all__ = ["Accesses", "Beats", "Device", "DeviceError", "DeviceTimeout", "frame_beats"]

Beats = npt.NDArray[np.uint16]
"""Video beats: grey | start of frame << 8 | end of line << 9."""


def frame_beats(frame: Image) -> Beats:
    """The beats of one good frame, uint8 (height, width), as a flat array."""
    beats = frame.astype(np.uint16)
    beats[:, -1] |= 1 << 9
    beats[0, 0] |= 1 << 8
    return beats.reshape(-1)


class Closed:
    """In place of the library of a board that was closed."""

    def __getattr__(self, name: str) -> Any:
        raise DeviceError("the board is closed: make another one")


class Device(RegisterDriver):
    """One simulated board.

    Args:
        config: configuration or its name.
        trace: file for a wave dump (a slower build); None for none.
        checked: take the build with the RTL's assertions live (slower): see `asserted`.
        power_up: seed of the registers' values at power-up, for a checked build; 0 for all registers 0.

    Raises:
        sim.board.build.BuildError: if the board cannot be built.
    """

    def __init__(self, config: Config | str = "full", trace: Path | None = None, checked: bool = False,
                 power_up: int = 0) -> None:
        config = CONFIGS[config] if isinstance(config, str) else config
        if CONFIGS.get(config.name) != config:
            raise ValueError(f"{config.name!r} is not a configuration the RTL is generated for")
        streams = MAP if config.dense_offsets else SURFACE
        library = load(build(config.name, trace is not None, checked), {**BOARD, **streams})
        self._board: int | None = library.slog_new(power_up)
        super().__init__(config, library, library.slog_driver(self._board))
        if trace is not None:
            self._lib.slog_trace(self._board, str(trace).encode())
        self.reset()
        self._check_build()

    def close(self) -> None:
        """Free the simulation and finish its wave dump."""
        if self._board is not None:
            self._lib.slog_free(self._board)
            closed: Any = Closed()
            self._board, self._lib = None, closed

    @property
    def clocks(self) -> int:
        """Clocks since the simulation began."""
        return int(self._lib.slog_clocks(self._board))

    @property
    def irq(self) -> bool:
        """The interrupt output."""
        return bool(self._lib.slog_irq(self._board))

    @property
    def asserted(self) -> bool:
        """Whether an assertion of the RTL has failed, in a checked build; its message is on the standard output."""
        return bool(self._lib.slog_asserted(self._board))

    def accesses(self, accesses: Accesses, overlap: int = 1) -> int:
        """Play register accesses on the five channels of the bus, each in its own time; fills in what was answered.

        Args:
            accesses: array of `ACCESS_DTYPE`, in order; an access that got no answer keeps `answered` 0.
            overlap: accesses under way at once; 1 keeps the order of reads and writes among each other.

        Returns:
            How many rules of AXI4-Lite the board broke: responses without a request or changed before they were taken.
        """
        broken: int = self._lib.slog_accesses(self._board, accesses.ctypes.data, len(accesses), overlap)
        return broken

    def tick(self, clocks: int) -> None:
        """Run for some clocks."""
        self._lib.slog_tick(self._board, clocks)

    def reset(self) -> None:
        """Reset the board and clear its queues. Slots become invalid; coefficients 0; size the largest."""
        self._lib.slog_reset(self._board)
        self.size = (self.config.max_width, self.config.max_height)
        self._check("reset")

    def restart(self, clocks: int = 1) -> None:
        """Reset the board for some clocks while the cameras go on sending what was queued; else as `reset`."""
        self._lib.slog_restart(self._board, clocks)
        self.size = (self.config.max_width, self.config.max_height)
        self._check("reset")

    # ---------------------------------------------------------------------------------------------------------- video
    def play(self, frame: Image, camera: int = 0, pause: float = 0.0, seed: int = 1) -> None:
        """Queue a frame, uint8 (height, width), on a camera; it plays while other calls run the clock.

        Args:
            pause: probability that a pixel is held back in a clock.
            seed: of the pauses.

        Raises:
            ValueError: if the board has no such camera.
        """
        self._check_camera(camera)
        pixels = np.ascontiguousarray(frame, np.uint8)
        self._lib.slog_play_frame(self._board, camera, pixels.ctypes.data, pixels.shape[1], pixels.shape[0],
                                  round(pause * 1000), seed)

    def play_beats(self, beats: Beats, camera: int = 0, pause: float = 0.0, seed: int = 1) -> None:
        """Queue raw beats, good or bad frames alike."""
        self._check_camera(camera)
        flat = np.ascontiguousarray(beats, np.uint16)
        self._lib.slog_play(self._board, camera, flat.ctypes.data, len(flat), round(pause * 1000), seed)

    def _check_camera(self, camera: int) -> None:
        if not 0 <= camera < self.config.cameras:
            raise ValueError(f"camera {camera}: this board has {self.config.cameras}")

    @property
    def playing_clocks(self) -> int:
        """Clocks allowed for queued frames, whose pixels may be held back."""
        return 8 * self._frame_clocks()

    def finish_playing(self) -> None:
        """Run until the cameras' queued beats are taken.

        Raises:
            DeviceTimeout: if the board stops taking them.
        """
        self._check("video", self._lib.slog_finish_playing(self._board, self.playing_clocks))

    def capture(self, slots: dict[int, int], frames: dict[int, Image], pause: float = 0.0, seed: int = 1) -> None:
        """Send one frame through each camera named, all at once, into its slot; both arguments by camera.

        Raises:
            DeviceError: if the board refuses, drops a frame, or does not finish; no request of these cameras is left.
        """
        drops = {c: self.read(f"counter.drops[{c}].value") for c in frames}
        try:
            for camera, slot in slots.items():
                self.arm(slot, camera)
            for camera, frame in frames.items():
                self.play(frame, camera, pause, seed + camera)
            self.finish_playing()
            lost = [c for c in frames if self.read(f"counter.drops[{c}].value") != drops[c]]
            if lost:
                raise DeviceError(f"the board dropped the frame of camera {', '.join(map(str, lost))}")
            self.wait_captured(*slots)
        except DeviceError:
            for camera in slots:
                with suppress(DeviceError):
                    self.disarm(camera)
            raise

    # --------------------------------------------------------------------------------------------------------- streams
    def surface(self, count: int) -> npt.NDArray[np.int32]:
        """The next `count` scores of the surface stream, on a board with the array.

        Raises:
            DeviceError: if they do not arrive, or first and last marks are wrong.
        """
        scores = np.zeros(count, np.uint16)
        code = self._lib.slog_surface(self._board, scores.ctypes.data, count, 10 * SLACK)
        self._check("surface", code)
        if code == STREAM_BROKEN:
            raise DeviceError(f"surface: wrong first or last marks at clock {self.clocks}")
        return scores.astype(np.int32)

    def map_words(self, room: int, timeout: int | None = None) -> npt.NDArray[np.uint64]:
        """The words of the next map, on a board with a dense engine: all up to its last mark.

        Args:
            room: most words that it may have.
            timeout: clocks without a word after which it counts as lost; by default more than a pass takes, for of
                coarse steps the words come far apart.

        Raises:
            DeviceError: if it does not arrive whole, has more words, or its first mark is wrong.
        """
        words = np.zeros(room, np.uint64)
        timeout = self._frame_clocks() if timeout is None else timeout
        count = int(self._lib.slog_map(self._board, words.ctypes.data, room, timeout))
        self._check("map", count)
        if count == STREAM_BROKEN:
            raise DeviceError(f"map: wrong first or last marks at clock {self.clocks}")
        return words[:count]

    @property
    def stream_waiting(self) -> int:
        """Scores or words of maps that have streamed out and were not taken."""
        return int(self._lib.slog_stream_waiting(self._board))

    def pause_stream(self, pause: float, seed: int = 1) -> None:
        """Make the receiver of surfaces or maps hold the stream back in this share of the clocks."""
        self._lib.slog_pause_stream(self._board, round(pause * 1000), seed)

    def _bus_error(self, what: str) -> DeviceError:
        return DeviceTimeout(f"{what}: the register bus does not answer (clock {self.clocks})")

    def _when(self) -> str:
        return f" up to clock {self.clocks}"
