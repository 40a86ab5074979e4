"""Free configurations near colliding ones, and free samples."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sscc._text import counted, number


class Resolved(NamedTuple):
    """A free q near a colliding one, from ``Certificates.resolve``."""

    resolved: bool
    """Whether a free q was found."""
    q: NDArray[np.float64] | None
    """The free q (r,), which is the given q if that is free. None if none was found."""
    change: float
    """The distance of the free q from the given q in the metric, ``|S (free q - q)|``; infinite if none was found."""
    safe_scale_change: float
    """The distance from the given q to the last free q on the line from the start to it; 0 if the given q is free, infinite if no
    free q was found."""

    def __repr__(self) -> str:
        if self.q is None:
            return "<sscc.Resolved: not resolved>"
        if self.change == 0:
            return f"<sscc.Resolved: free as it is, q of shape ({len(self.q)},)>"
        back = number(self.safe_scale_change)
        change = f"change {number(self.change)} (stepping back: {back})"
        return f"<sscc.Resolved: resolved, {change}, q of shape ({len(self.q)},)>"


class FreeSamples(NamedTuple):
    """Free configurations from draws, from ``Certificates.free_samples``."""

    q: NDArray[np.float64]
    """The free configurations (m, r), in the order of their draws."""
    draws: NDArray[np.int64]
    """The row in the draws of each free configuration (m,)."""
    changes: NDArray[np.float64]
    """The distance of each free configuration from its draw, in the metric (m,): 0 where the draw was free."""
    drawn: int
    """Number of draws."""
    free: int
    """Number of draws that were free."""

    @property
    def acceptance(self) -> float:
        """The share of draws that were free; NaN without draws."""
        return self.free / self.drawn if self.drawn else float("nan")

    def __repr__(self) -> str:
        rows, rank = self.q.shape
        draws = f"{counted(self.drawn, 'draw')} ({self.free:,} of them free)"
        return f"<sscc.FreeSamples: {counted(rows, 'free configuration')} from {draws}, q of shape ({rows}, {rank})>"
