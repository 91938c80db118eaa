# SPDX-License-Identifier: Apache-2.0
"""The search range that follows the prediction errors."""

import numpy as np

from signum.measure.predict import SearchPredictor


def test_predictor() -> None:
    p = SearchPredictor(floor=6, widest=32)
    assert p.reach == 32
    p.learn(np.zeros(10), 10)
    assert p.reach == 16
    p.learn(np.zeros(10), 10)
    p.learn(np.zeros(10), 10)
    assert p.reach == 6
    p.learn(np.full(10, 2.0), 10)
    assert p.reach == 12
    p.learn(np.zeros(4), 10)
    assert p.reach == 32
