"""The time of impact of two moving triangles in exact arithmetic: simple and slow.

Two triangles meet exactly when some corners of one and some of the other, at most five together, form a Radon
partition: their homogeneous coordinates have exactly one linear dependency, which is positive on one side and negative
on the other. A partition of five corners holds during an interval of time. So at an impact after time 0 there is a
partition of at most four corners. These are in one plane, so the time is a root of their determinant. If that
determinant is always zero, a coefficient of the dependency changes its sign, so the time is a root of a smaller
determinant.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from fractions import Fraction
from itertools import chain, combinations

import numpy as np
from numpy.typing import NDArray

from polynomial import Polynomial, Root, add, multiply, negate, rational, refine, roots, sign_at, trimmed

Set = tuple[int, ...]
#: The width of the interval that contains the time, before the time is rounded.
WIDTH = Fraction(1, 2**60)


def first_contact(corners: NDArray[np.float64]) -> float | None:
    """Returns the first time in [0, 1] at which two triangles have a common point, rounded; None if they have none.

    corners: (2, 2, 3, 3), for each triangle its corners at the start and at the end.
    """
    pair = Pair(corners)
    start = rational(Fraction(0))
    if any(pair.is_partition(some, start) for some in mixed(range(6), 5)):
        return 0.0
    times = [(refine(root, WIDTH), some) for some in pair.critical_sets() for root in pair.roots(some)]
    for root, some in sorted(times, key=lambda time: time[0].low):
        if any(pair.is_partition(part, root) for part in mixed(some, 4)):
            return float(root.low)
    return None


def mixed(corners: Iterable[int], most: int) -> Iterator[Set]:
    """Returns all sets of at most this many corners with some of each triangle: 0, 1, 2 and 3, 4, 5."""
    corners = tuple(corners)
    sets = chain.from_iterable(combinations(corners, size) for size in range(2, most + 1))
    return (some for some in sets if some[0] < 3 <= some[-1])


class Pair:
    """Two moving triangles."""

    def __init__(self, corners: NDArray[np.float64]) -> None:
        starts, ends = np.swapaxes(corners, 0, 1).reshape(2, 6, 3).tolist()
        # Coordinates are multiplied by a common denominator, which changes no sign and no root.
        scale = max(x.as_integer_ratio()[1] for corner in starts + ends for x in corner)

        def whole(x: float) -> int:
            p, q = x.as_integer_ratio()
            return p * (scale // q)

        #: Homogeneous coordinates of each corner, linear in time.
        self.coordinates = [
            [trimmed([whole(p), whole(q) - whole(p)]) for p, q in zip(start, end, strict=True)] + [(1,)]
            for start, end in zip(starts, ends, strict=True)
        ]
        self.minors: dict[tuple[Set, Set], Polynomial] = {((), ()): (1,)}

    def minor(self, some: Set, rows: Set) -> Polynomial:
        """Returns the determinant of some corners and as many coordinates."""
        if (some, rows) not in self.minors:
            total: Polynomial = ()
            for i, row in enumerate(rows):
                term = multiply(self.coordinates[some[0]][row], self.minor(some[1:], rows[:i] + rows[i + 1 :]))
                total = add(total, negate(term) if i % 2 else term)
            self.minors[some, rows] = total
        return self.minors[some, rows]

    def critical_sets(self) -> Iterator[Set]:
        """Returns sets of corners, one of which is a partition at the impact, unless the impact is at time 0."""
        fours = list(combinations(range(6), 4))
        yield from fours
        if not all(self.minor(some, (0, 1, 2, 3)) for some in fours):
            yield from mixed(range(6), 3)

    def roots(self, some: Set) -> list[Root]:
        """Returns times at which the corners of a set can become dependent."""
        minors = {self.minor(some, rows) for rows in combinations(range(4), len(some))}
        return [root for minor in minors if minor for root in roots(minor)]

    def is_partition(self, some: Set, time: Root) -> bool:
        """Whether corners have exactly one dependency at a time, positive on one triangle, negative on the other."""
        for rows in combinations(range(4), len(some) - 1):
            # By Cramer's rule this is the only dependency within these rows, unless it is 0.
            others = [self.minor(some[:i] + some[i + 1 :], rows) for i in range(len(some))]
            signs = [-sign_at(p, time) if i % 2 else sign_at(p, time) for i, p in enumerate(others)]
            if any(signs):
                sides = [1 if corner < 3 else -1 for corner in some]
                return signs in (sides, [-side for side in sides]) and self.is_dependency(some, rows, time)
        return False

    def is_dependency(self, some: Set, rows: Set, time: Root) -> bool:
        """Whether the dependency within these rows holds in every other row: the determinant with that row is 0."""
        others = (tuple(sorted((*rows, row))) for row in set(range(4)) - set(rows))
        return all(sign_at(self.minor(some, all_rows), time) == 0 for all_rows in others)
