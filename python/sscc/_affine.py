"""Modes of affine maps that are blended by weights, as for bones of a skin and handles of Simplicits."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def affine_modes(vertices: NDArray[np.float64], weights: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns U (V, 3, 12 H): ``U q`` is the sum of ``weights[:, h] * (A_h @ (vertices, 1))`` over h.

    vertices: (V, 3); weights: (V, H). q has the entries of each A_h (3, 4), row by row.
    """
    x = np.concatenate([vertices, np.ones((len(vertices), 1))], axis=1)
    moved = (weights[:, :, None] * x[:, None, :]).reshape(len(x), weights.shape[1], 4)
    modes = np.zeros((len(x), 3, moved.shape[1], 3, 4))
    for axis in range(3):
        modes[:, axis, :, axis, :] = moved
    return modes.reshape(len(x), 3, 12 * weights.shape[1])
