"""Checks of arrays, for the parts of the package that are written in Python."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def check_finite(array: NDArray[np.float64], name: str) -> None:
    """Refuses NaN and infinities."""
    if not np.isfinite(array).all():
        place = [int(i) for i in np.argwhere(~np.isfinite(array))[0]]
        raise ValueError(f"{name}{place} is {array[tuple(place)]}: every entry must be finite")
