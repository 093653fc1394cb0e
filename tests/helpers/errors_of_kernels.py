"""Errors of kernels in eps, against the expressions of the derivation at 50 digits."""

from __future__ import annotations

import itertools

import numpy as np

from helpers.kernel_modules import EPS, QUANTITIES
from helpers.motions import derived
from helpers.witness import evaluate, mp

SPECIAL = np.array([*itertools.product(np.pi / 4 * np.arange(-4, 5), repeat=3)])


def angles_of_all_sizes() -> np.ndarray:
    rng = np.random.default_rng(3)
    sizes = (1e-8, 1.0, np.pi, 1e4)
    return np.concatenate([rng.uniform(-s, s, (40, 3)) for s in sizes] + [SPECIAL[::9]])


def exactly(sequence: str, name: str, arrays: list[np.ndarray]) -> list[list]:
    """The derivation's own expression at 50 digits, entry by entry, point by point."""
    motion = derived(sequence)
    symbols = [s for a in QUANTITIES[name][0] for s in motion.argument(a).symbols]
    points = zip(*(array.tolist() for array in arrays), strict=True)
    values = (dict(zip(symbols, map(mp.mpf, itertools.chain(*p)), strict=True)) for p in points)
    return [list(evaluate(motion.spelled(motion.step(name).expression), known)) for known in values]


def worst_error(found: np.ndarray, exact: list[list], scales: np.ndarray | None = None) -> float:
    """The largest error in eps of the largest entry at its point, or of a given scale."""
    worst = 0.0
    for k, (values, truth) in enumerate(
        zip(found.reshape(len(exact), -1).tolist(), exact, strict=True)
    ):
        scale = max(map(abs, truth)) if scales is None else mp.mpf(scales[k])
        errors = [abs(mp.mpf(v) - t) / scale for v, t in zip(values, truth, strict=True)]
        worst = max(worst, float(max(errors)) / EPS)
    return worst
