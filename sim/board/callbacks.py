# SPDX-License-Identifier: Apache-2.0
"""The register driver on a pair of Python functions: for a board reached over UART or Ethernet, and for tests."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any

from golden.params import CONFIGS, Config
from sim.board.build import build_driver
from sim.board.driver import DeviceError, RegisterDriver
from sim.board.library import CALLBACKS, READ, WRITE, load


class CallbackDriver(RegisterDriver):
    """A board whose registers two functions read and write; it must have been reset.

    Args:
        config: configuration of the board, or its name.
        read: returns the 32-bit register at a byte address.
        write: writes the 32-bit register at a byte address.

    Raises:
        DeviceError: if the board is of another configuration, or a function raises: its exception is the cause. No
            access follows one that failed.
    """

    def __init__(self, config: Config | str, read: Callable[[int], int], write: Callable[[int, int], object]) -> None:
        self._exception: Exception | None = None
        # ctypes needs both functions alive while the driver is.
        self._functions = READ(self._guarded(lambda where, data: _store(data, read(where)))), WRITE(
            self._guarded(write))
        library = load(build_driver(), CALLBACKS)
        self._handle: int | None = library.slog_callbacks_new(*self._functions)
        config = CONFIGS[config] if isinstance(config, str) else config
        super().__init__(config, library, library.slog_driver(self._handle))
        library.slog_start(self._driver)
        self._check("start")
        self._check_build()

    def close(self) -> None:
        """Free the driver."""
        if self._handle is not None:
            self._lib.slog_callbacks_free(self._handle)
            self._handle = None

    def _guarded(self, access: Callable[..., object]) -> Callable[..., int]:
        def guarded(*arguments: Any) -> int:
            try:
                access(*arguments)
            except Exception as error:
                self._exception = error
                return 1
            return 0
        return guarded

    def _bus_error(self, what: str) -> DeviceError:
        error = DeviceError(f"{what}: {self._exception}")
        error.__cause__ = self._exception
        return error


def _store(data: Any, value: int) -> None:
    data[0] = ctypes.c_uint32(value).value
