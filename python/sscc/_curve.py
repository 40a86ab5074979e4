"""Curves in which surfaces intersect."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sscc._text import counted


class Curve(NamedTuple):
    """A polyline in which a mesh intersects itself or another one. Its arrays are read-only."""

    points: NDArray[np.float64]
    """The points (n, 3), each within rounding of the exact point. A closed curve does not repeat its first point."""
    pairs: NDArray[np.uint32]
    """The pair of triangles of each segment, from a point to the next: (n - 1, 2), or (n, 2) for a closed curve."""
    closed: bool
    """Whether the last point is joined to the first."""

    def __repr__(self) -> str:
        kind = "closed" if self.closed else "open"
        return f"<sscc.Curve: {kind}, {counted(len(self.points), 'point')}, {counted(len(self.pairs), 'segment')}>"
