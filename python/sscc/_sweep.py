"""Sweeps of the weights of modes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sscc._text import counted, number, quoted


class Sweep(NamedTuple):
    """The free range of the weight of one mode in one direction, with all other weights fixed."""

    mode: int
    """The mode, counted from 0."""
    name: str
    """The name of the mode, or its number."""
    start: float
    """The weight at which the sweep starts."""
    end: float
    """The weight at which the sweep ends."""
    first_free: float | None
    """The shape is proven free at every weight from ``start`` to this one. None if it collides at ``start``."""
    first_hit: float | None
    """A weight at which the shape collides: without a note, the first one, at most 1e-9 of the range beyond ``first_free``.
    With a note it is ``start``, a weight with a grazing contact, or a collision farther away. None if none was found."""
    pairs: NDArray[np.uint32]
    """The pairs that collide at ``first_hit``: (n, 2), i < j, sorted, read-only."""
    note: str | None
    """An unusual event: a collision at ``start``, a grazing contact, or the reason why ``first_hit`` is farther away or None."""

    def __repr__(self) -> str:
        name = f"mode {self.mode}" if self.name == str(self.mode) else f"mode {self.mode} {quoted(self.name)}"
        return f"<sscc.Sweep: {name} from {number(self.start)} to {number(self.end)}: {self._result()}>"

    def _result(self) -> str:
        pairs = counted(len(self.pairs), "pair")
        if self.first_free is None:
            return f"colliding at the start, {pairs}"
        if self.first_free == self.end:
            return "free"
        if self.first_hit is None:
            return f"free up to {number(self.first_free)}, not proven beyond"
        if self.note is None:
            return f"touches at {number(self.first_hit)}, {pairs}"
        return f"free up to {number(self.first_free)}, touches at {number(self.first_hit)}, {pairs} (see note)"


class Interval(NamedTuple):
    """An interval of weights over which the shape collides at every sample."""

    start: float
    """The first weight of the interval."""
    end: float
    """The last weight of the interval."""
    free_until: float | None
    """The shape is proven free up to this weight, from the interval before or the lower end of the range. None if the interval
    begins at that end."""
    free_from: float | None
    """The shape is proven free from this weight on, up to the next interval. None if the interval ends at the upper end of the
    range."""
    exact: bool
    """Whether the shape collides at ``start`` and ``end``, which are then at most 1e-9 of a sweep's range from the free weights
    beside them. Otherwise nothing is proven beyond the free weights."""
    pairs: int
    """The maximum number of pairs that collide at a sample inside, at an end, or at a collision found beyond an inexact end."""
    depth: float
    """The largest penetration depth of a pair (model unit)."""
    deepest: float
    """The weight with that depth."""

    def __repr__(self) -> str:
        found = f"{counted(self.pairs, 'pair')}, depth {number(self.depth)} at {number(self.deepest)}"
        return f"<sscc.Interval: from {number(self.start)} to {number(self.end)}: up to {found}>"


class Intervals(NamedTuple):
    """The intervals of one mode's weight over which the shape collides, with all others fixed."""

    mode: int
    """The mode, counted from 0."""
    name: str
    """The name of the mode, or its number."""
    start: float
    """The smallest weight."""
    end: float
    """The largest weight."""
    intervals: list[Interval]
    """The intervals in ascending order. The shape is proven free outside of them, up to their ``free_until`` and from their
    ``free_from`` on."""
    samples: NDArray[np.float64]
    """Weight, number of pairs and largest penetration depth of each sample: (n, 3), read-only."""

    def __repr__(self) -> str:
        name = f"mode {self.mode}" if self.name == str(self.mode) else f"mode {self.mode} {quoted(self.name)}"
        found = counted(len(self.intervals), "interval") if self.intervals else "free"
        return f"<sscc.Intervals: {name} from {number(self.start)} to {number(self.end)}: {found}>"
