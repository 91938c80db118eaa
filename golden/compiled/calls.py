# SPDX-License-Identifier: Apache-2.0
"""Calls of the compiled kernel, with NumPy arrays.

`SIGNUM_KERNEL` chooses: `numpy` for none, or the name of a variant (`plain`, `popcnt`, `avx2`, `avx512`); without it,
the fastest that the processor has.
"""

from __future__ import annotations

import ctypes
import os
from collections.abc import Mapping
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from golden.compiled.build import KernelError, library
from golden.dense_job import DenseJob, DenseResult
from golden.log import Image, kernels
from golden.tables import RESULT_FIELDS, IntTable, refused_table

CHOICE = "SIGNUM_KERNEL"
NUMPY = "numpy"
Packed = npt.NDArray[np.uint64]
"""A sign plane in 64-bit words, (height, words): pixel x of a row is bit x % 64 of word x // 64, and a word more."""
_FOUND = len(RESULT_FIELDS) - 1
"""Columns of the kernel's results: those of a table, without the status."""


class Kernel:
    """The compiled kernel, in the variant for some set of instructions."""

    def __init__(self, code: ctypes.CDLL, index: int, variant: str) -> None:
        self._code, self._index, self.variant = code, index, variant

    def sign(self, image: Image, sigma: float, radius: int) -> Packed:
        """Sign plane of a grey image, packed; arguments, signs and errors are those of `golden.log.sign`."""
        return self._filter(image, sigma, radius, None)

    def response(self, image: Image, sigma: float, radius: int) -> npt.NDArray[np.int64]:
        """LoG response of a grey image, as `golden.log.response`."""
        out = np.empty(image.shape, np.int64)
        self._filter(image, sigma, radius, out)
        return out

    def _filter(self, image: Image, sigma: float, radius: int, out: npt.NDArray[np.int64] | None) -> Packed:
        taps = np.array(kernels(sigma, radius), np.int32)
        if image.ndim != 2 or image.dtype != np.uint8 or image.size == 0:
            raise ValueError(f"expected an 8-bit grey image, not {image.dtype} {image.shape}")
        image = np.ascontiguousarray(image)
        height, width = image.shape
        signs = np.empty((height, _words(width)), np.uint64)
        _enough(self._code.slog_filter(self._index, image.ctypes.data, width, height, taps.ctypes.data, radius,
                                       signs.ctypes.data, signs.shape[1], None if out is None else out.ctypes.data))
        return signs

    def search(self, jobs: IntTable, planes: Mapping[int, Packed]) -> IntTable:
        """Results of jobs that `golden.correlate.check` accepts.

        Args:
            jobs: table with columns JOB_FIELDS.
            planes: by slot, all of one size.

        Returns:
            A table with columns RESULT_FIELDS, as `golden.correlate.run` gives them.
        """
        return self._search(jobs, planes, None)

    def surface(self, job: IntTable, planes: Mapping[int, Packed]) -> tuple[IntTable, IntTable]:
        """Result and scores, (offsets_y, offsets_x), of one job, a table of one row; see `search`."""
        scores = np.empty((job[0, -1], job[0, -2]), np.int32)
        return self._search(job, planes, scores), scores

    def _search(self, jobs: IntTable, planes: Mapping[int, Packed], scores: IntTable | None) -> IntTable:
        found = np.empty((len(jobs), _FOUND), np.int32)
        table = refused_table(len(jobs))
        if not len(jobs):
            return table
        jobs = np.ascontiguousarray(jobs, np.int32)
        places = (ctypes.c_void_p * (1 + max(planes)))(
            *(planes[slot].ctypes.data if slot in planes else None for slot in range(1 + max(planes))))
        pitch = next(iter(planes.values())).shape[1]
        _enough(self._code.slog_search(self._index, places, pitch, jobs.ctypes.data, found.ctypes.data, len(jobs),
                                       None if scores is None else scores.ctypes.data))
        table[:, 1:] = found
        return table


    def dense(self, left: Packed, right: Packed, width: int, job: DenseJob) -> DenseResult:
        """Winners of a job that `golden.dense_job.check_job` accepts, on the planes of its two slots, `width` pixels
        wide, as `golden.dense_job.run_dense` gives them."""
        height, one = len(left), job.search
        shape = -(-height // job.step[1]), -(-width // job.step[0])
        counts = [np.empty(shape, np.int16) for _ in range(5)]
        flags = [np.empty(shape, np.bool_) for _ in range(3)]
        numbers = np.array((one.window, one.offsets, one.start, one.down, *job.step, job.most, job.margin, job.check),
                           np.int32)
        maps = (ctypes.c_void_p * 8)(*(field.ctypes.data for field in (*counts, *flags)))
        _enough(self._code.slog_dense(self._index, left.ctypes.data, right.ctypes.data, left.shape[1], width, height,
                                      numbers.ctypes.data, maps))
        index, best, lower, upper, rest = counts
        found, agrees, valid = flags
        return DenseResult(index, best, lower, upper, rest, found, agrees, valid)


def pack(plane: Image) -> Packed:
    """A sign plane, uint8 0/1 (height, width), in words."""
    height, width = plane.shape
    out = np.zeros((height, 8 * _words(width)), np.uint8)
    bits = np.packbits(plane, axis=1, bitorder="little")
    out[:, :bits.shape[1]] = bits
    return out.view("<u8").astype(np.uint64, copy=False)


def unpack(plane: Packed, width: int) -> Image:
    """A sign plane in words as uint8 0/1 (height, width)."""
    return np.unpackbits(plane.astype("<u8", copy=False).view(np.uint8), axis=1, count=width, bitorder="little")


@lru_cache(maxsize=1)
def variants() -> dict[str, Kernel]:
    """The kernels that this processor can run, by name, from the slowest to the fastest.

    Raises:
        KernelError: if the library cannot be compiled or loaded.
    """
    path = library()
    try:
        code = ctypes.CDLL(os.fspath(path))
    except OSError as error:
        raise KernelError(" ".join(str(error).split())) from error
    pointer, whole = ctypes.c_void_p, ctypes.c_int
    code.slog_variant.argtypes, code.slog_variant.restype = [whole], ctypes.c_char_p
    code.slog_filter.argtypes = [whole, pointer, whole, whole, pointer, whole, pointer, whole, pointer]
    code.slog_search.argtypes = [whole, pointer, whole, pointer, pointer, ctypes.c_long, pointer]
    code.slog_dense.argtypes = [whole, pointer, pointer, whole, whole, whole, pointer, pointer]
    names: list[str] = []
    while (name := code.slog_variant(len(names))) is not None:
        names.append(name.decode())
    return {name: Kernel(code, index, name) for index, name in enumerate(names) if name}


def choose() -> tuple[Kernel | None, str]:
    """The kernel to use, None for NumPy, and a phrase that says what computes and why.

    Raises:
        ValueError: if `SIGNUM_KERNEL` names a variant that there is not.
    """
    wanted = os.environ.get(CHOICE, "")
    if wanted == NUMPY:
        return None, f"NumPy, chosen by {CHOICE}"
    try:
        found = variants()
    except KernelError as error:
        if wanted:
            raise ValueError(f"{CHOICE} is {wanted}, but the kernel cannot be had: {error}") from error
        return None, f"NumPy, as the kernel cannot be had: {error}"
    if wanted and wanted not in found:
        raise ValueError(f"{CHOICE} is {wanted}: this processor has {', '.join((NUMPY, *found))}")
    kernel = found[wanted] if wanted else list(found.values())[-1]
    return kernel, f"compiled, {kernel.variant}"


def _words(width: int) -> int:
    return -(-width // 64) + 1


def _enough(failed: int) -> None:
    if failed:
        raise MemoryError("the kernel needs more memory than there is")
