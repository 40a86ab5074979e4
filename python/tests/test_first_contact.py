"""Tests of the exact oracle for continuous queries, with times of impact that are computed by hand."""

from __future__ import annotations

from math import sqrt

import numpy as np
import pytest
from numpy.typing import NDArray

from first_contact import first_contact

F64 = NDArray[np.float64]

FACE = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], float)
#: One of its edges is along z.
UPRIGHT = np.array([[0, 0, -0.5], [0, 0, 0.5], [0, -1, 0]])
#: The plane of this face rotates about the y axis: z = t x.
TURNING = (FACE, FACE + np.array([[0, 0, 0], [0, 0, 1], [0, 0, 0]]))


def time(x: tuple[F64, F64], y: tuple[F64, F64]) -> float | None:
    """Returns the time of impact, which must not depend on the order of the triangles."""
    one, other = (first_contact(np.array(pair)) for pair in ((x, y), (y, x)))
    assert one == other
    return one


def moved(triangle: F64, start: tuple[float, ...], end: tuple[float, ...]) -> tuple[F64, F64]:
    return triangle + start, triangle + end


def below(start: tuple[float, ...], end: tuple[float, ...], sign: int = -1) -> tuple[F64, F64]:
    """Returns a moving triangle with one corner between these positions; the other corners are far below or above it."""
    other = sign * np.array([[0, 0, 0], [0.25, 0, 8], [0, 0.25, 8]])
    return moved(other, start, end)


@pytest.mark.parametrize(
    ("x", "y", "expected"),
    [
        # A corner meets a face; an edge meets an edge.
        ((FACE, FACE), below((0.25, 0.25, -1), (0.25, 0.25, 2)), 1 / 3),
        ((FACE, FACE), moved(UPRIGHT, (0.5, -1, 0), (0.5, 1, 0)), 0.5),
        ((FACE, FACE), moved(UPRIGHT, (1.5, -1, 0), (1.5, 1, 0)), None),
        # The faces are parallel: all corners are in one plane when they meet.
        ((FACE, FACE), moved(FACE, (0.25, 0.25, 3), (0.25, 0.25, -1)), 0.75),
        # The time is irrational; then the triangles touch and separate again; then they do not touch.
        (TURNING, below((0.25, 0.125, 0.5), (0.75, 0.125, 0.5), 1), (sqrt(17) - 1) / 4),
        (TURNING, below((0.25, 0.125, -0.25), (1.25, 0.125, 1)), 0.5),
        (TURNING, below((0.25, 0.125, -0.25 - 2**-40), (1.25, 0.125, 1 - 2**-40)), None),
        # All corners are in one plane all the time: a corner meets an edge, or a corner.
        ((FACE, FACE), moved(FACE, (-2, 0.25, 0), (0, 0.25, 0)), 0.5),
        ((FACE, FACE), moved(FACE, (2, 0, 0), (0, 0, 0)), 0.5),
        ((FACE, FACE), moved(FACE, (2, 2, 0), (0.75, 0.75, 0)), None),
        # All corners are on one line.
        ((FACE[[0, 1, 1]], FACE[[0, 1, 1]]), moved(FACE[[0, 0, 1]], (5, 0, 0), (-5, 0, 0)), 0.4),
        # They touch at the end of the motion, just do not touch, touch at its start, or touch all the time.
        ((FACE, FACE), below((0.25, 0.25, -1), (0.25, 0.25, 0)), 1.0),
        ((FACE, FACE), below((0.25, 0.25, -1), (0.25, 0.25, -(2.0**-1074))), None),
        ((FACE, FACE), below((0.25, 0.25, 0), (0.25, 0.25, -1)), 0.0),
        ((FACE, FACE), below((0.25, 0.25, 1), (0.25, 0.25, 1)), 0.0),
    ],
)
def test_times_equal_those_computed_by_hand(x: tuple[F64, F64], y: tuple[F64, F64], expected: float | None) -> None:
    assert time(x, y) == (None if expected is None else pytest.approx(expected, abs=2.0**-52))
