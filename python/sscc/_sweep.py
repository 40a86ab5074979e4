"""Sweeps of the weights of modes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sscc._text import counted, number, quoted


class Sweep(NamedTuple):
    """How far the weight of one mode can go, with all others fixed, until the shape touches itself."""

    mode: int
    """The mode, counted from 0."""
    name: str
    """Its name, or its number."""
    start: float
    """The weight at which the sweep starts."""
    end: float
    """The weight at which it ends."""
    first_free: float | None
    """The shape is proven free at every weight from ``start`` to this one. None: it collides at ``start``."""
    first_hit: float | None
    """The first weight at which it collides, at most 1e-9 of the range beyond ``first_free``. None: none was found."""
    pairs: NDArray[np.uint32]
    """The pairs that collide at ``first_hit``: (n, 2), i < j, sorted, read-only."""
    note: str | None
    """What is unusual: a collision at ``start``, a grazing contact, or why ``first_hit`` is farther away or None."""

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
    """Its first weight."""
    end: float
    """Its last weight."""
    free_until: float | None
    """Up to this weight the shape is proven free. None: the interval begins at the end of the range."""
    free_from: float | None
    """From this weight on it is proven free. None: the interval ends at the end of the range."""
    exact: bool
    """Whether it collides at ``start`` and ``end``, at most 1e-9 of a sweep's way from the free weights."""
    pairs: int
    """The most pairs that collide at a sample or an end."""
    depth: float
    """The largest penetration depth of a pair (model unit)."""
    deepest: float
    """The weight of that depth."""

    def __repr__(self) -> str:
        found = f"{counted(self.pairs, 'pair')}, depth {number(self.depth)} at {number(self.deepest)}"
        return f"<sscc.Interval: from {number(self.start)} to {number(self.end)}: up to {found}>"


class Intervals(NamedTuple):
    """The intervals of one mode's weight over which the shape collides, with all others fixed."""

    mode: int
    """The mode, counted from 0."""
    name: str
    """Its name, or its number."""
    start: float
    """The smallest weight."""
    end: float
    """The largest weight."""
    intervals: list[Interval]
    """In ascending order; every weight outside of them is proven free."""
    samples: NDArray[np.float64]
    """Weight, number of pairs and largest penetration depth of each sample: (n, 3), read-only."""

    def __repr__(self) -> str:
        name = f"mode {self.mode}" if self.name == str(self.mode) else f"mode {self.mode} {quoted(self.name)}"
        found = counted(len(self.intervals), "interval") if self.intervals else "free"
        return f"<sscc.Intervals: {name} from {number(self.start)} to {number(self.end)}: {found}>"
