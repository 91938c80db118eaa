# SPDX-License-Identifier: Apache-2.0
"""A bit-plane store that holds given planes, as the surroundings of the correlator."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from golden.correlate import Plane
from golden.cycle.bits import or_zero
from golden.cycle.model import Outputs
from golden.cycle.store.store import StoreModel
from golden.params import Config


def plane_words(plane: Plane, config: Config) -> list[int]:
    """Words of a slot that holds `plane` (uint8 0/1, (H, W)): bit 0 leftmost, rows padded with zeros."""
    padded = np.zeros((config.max_height, config.words_per_row * config.group_bits), np.uint8)
    padded[:plane.shape[0], :plane.shape[1]] = plane
    packed = np.packbits(padded, bitorder="little").tobytes()
    size = config.group_bits // 8
    return [int.from_bytes(packed[k:k + size], "little") for k in range(0, len(packed), size)]


def filled_store(config: Config, planes: Mapping[int, Plane]) -> StoreModel:
    """The store with `planes` in their slots."""
    store = StoreModel(config.store_words)
    for slot, plane in planes.items():
        store.memory[slot * config.slot_words:(slot + 1) * config.slot_words] = plane_words(plane, config)
    return store


def read_store(store: StoreModel, out: Outputs) -> None:
    """One clock of `store` with the read requested by `out` (`rd_valid_o`, `rd_addr_o`) and nothing else."""
    store.step({**dict.fromkeys(StoreModel.INPUTS, 0), "rd_valid_i": or_zero(out["rd_valid_o"]),
                "rd_addr_i": or_zero(out["rd_addr_o"])})
