"""Curves and penetration depths of a detector's answers."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import sscc
from shapes import samples, torus
from test_interrupt import MAX_SECONDS, ctrl_c_handler, seconds_until_stopped  # noqa: F401

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

#: A triangle, and a triangle with a corner 0.25 below it.
FACE = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0]], float)
SPIKE = np.array([[1, 1, -0.25], [1, 1, 2], [2, 1, 2]])
ONE = [[0, 1, 2]]


def linked() -> tuple[F64, F64, I64]:
    """Returns positions of two tori that cross each other, and their faces. All coordinates have few digits, so that moving
    a torus is exact."""
    x, f, _ = torus(32, 16, 1)
    x = np.round(x * 2**20) / 2**20
    return x, x @ np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0.0]]) + [0.25, 0.125, 0.0625], f


def folded() -> tuple[F64, I64]:
    """Returns a torus that crosses itself."""
    x, f, modes = torus(32, 16, 6)
    return x + modes @ samples(1, 6, 0.6, seed=2)[0], f


def distance_to_triangle(point: F64, corners: F64) -> float:
    """Returns the distance of a point from a triangle: from its plane, and from its edges if it is beyond them."""
    a, b, c = corners
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal)
    beyond = [np.cross(q - p, normal) @ (point - p) / np.linalg.norm(q - p) for p, q in ((a, b), (b, c), (c, a))]
    return float(max(abs(normal @ (point - a)), *beyond))


def segments(curves: list[sscc.Curve]) -> dict[tuple[int, int], F64]:
    """Returns the ends of the segment of each pair, (2, 3). No pair may have two segments."""
    found: dict[tuple[int, int], F64] = {}
    for points, pairs, closed in curves:
        assert points.dtype == float and pairs.dtype == np.uint32
        assert points.shape == (len(pairs) + (not closed), 3) and pairs.shape == (len(pairs), 2) and len(pairs) > 0
        for number, (i, j) in enumerate(pairs.tolist()):
            assert (i, j) not in found
            found[i, j] = points[[number, (number + 1) % len(points)]]
    return found


def check_segments(curves: list[sscc.Curve], pairs: NDArray[np.uint32], first: F64, second: F64) -> None:
    """Checks that each segment is on both triangles of its pair. (F, 3, 3): the corners of the triangles."""
    found = segments(curves)
    assert found.keys() <= {(i, j) for i, j in pairs.tolist()}
    for (i, j), ends in found.items():
        for end in ends:
            assert max(distance_to_triangle(end, first[i]), distance_to_triangle(end, second[j])) < 1e-14


def test_a_corner_below_a_face() -> None:
    detector, spike = sscc.Detector(ONE, FACE), sscc.Detector(ONE, SPIKE)
    answer = detector.against(FACE, spike, SPIKE)
    (curve,) = answer.curves()
    assert type(curve) is sscc.Curve and curve.pairs.tolist() == [[0, 0]] and not curve.closed
    assert sorted(curve.points.tolist()) == [[1, 1, 0], [1 + 1 / 9, 1, 0]]
    assert answer.depths().tolist() == [0.25] and answer.directions().tolist() == [[0, 0, 1]]
    assert spike.against(SPIKE, detector, FACE).directions().tolist() == [[0, 0, -1]]
    for array in (curve.points, curve.pairs, answer.depths(), answer.directions()):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0
    # Both triangles are in one mesh.
    both = sscc.Detector([[0, 1, 2], [3, 4, 5]]).check(np.concatenate([FACE, SPIKE]))
    assert both.pairs.tolist() == [[0, 1]] and both.depths().tolist() == [0.25]
    assert [curve.pairs.tolist() for curve in both.curves()] == [[[0, 1]]]


def test_free_touching_and_coplanar_pairs() -> None:
    detector, other = sscc.Detector(ONE, FACE), sscc.Detector(ONE)
    free = detector.against(FACE, other, FACE + [0, 0, 1])
    assert free.curves() == [] and free.depths().shape == (0,) and free.directions().shape == (0, 3)
    touching = detector.against(FACE, other, SPIKE + [0, 0, 0.25])
    assert touching.count == 1 and touching.curves() == [] and touching.depths().tolist() == [0]
    coplanar = detector.against(FACE, other, FACE + [1, 1, 0])
    assert coplanar.count == 1 and coplanar.curves() == [] and coplanar.depths().tolist() == [0]
    assert np.abs(coplanar.directions()).tolist() == [[0, 0, 1]]


def test_closed_surfaces_cross_in_closed_curves() -> None:
    x, y, f = linked()
    answer = sscc.Detector(f, x).against(x, sscc.Detector(f, y), y)
    curves = answer.curves()
    assert answer.count > 100 and len(curves) > 1 and all(curve.closed for curve in curves)
    check_segments(curves, answer.pairs, x[f], y[f])
    assert len(segments(curves)) == answer.count
    # Both tori are in one mesh.
    whole = sscc.Detector(np.concatenate([f, f + len(x)])).check(np.concatenate([x, y])).curves()
    for one, two in zip(curves, whole, strict=True):
        assert np.array_equal(one.points, two.points) and np.array_equal(one.pairs + [0, len(f)], two.pairs)


def test_a_mesh_that_crosses_itself() -> None:
    x, f = folded()
    answer = sscc.Detector(f).check(x)
    curves = answer.curves()
    check_segments(curves, answer.pairs, x[f], x[f])
    assert answer.count > 50 and len(segments(curves)) == answer.count
    batch = sscc.Detector(f).check_many([x * 0.5, x])
    assert segments(batch[1].curves()).keys() == segments(curves).keys()
    assert np.array_equal(batch[1].depths(), answer.depths())
    assert np.array_equal(batch[0].depths(), answer.depths() / 2)
    # A part of the pairs has open curves.
    some = sscc.Detector(f).check(x, 7)
    assert len(some.depths()) == 7 and len(segments(some.curves())) == 7


def test_curves_pass_seams() -> None:
    """Each triangle has its own vertices, and vertices at equal positions are welded."""
    x, f = folded()
    split, own = x[f].reshape(-1, 3), np.arange(3 * len(f)).reshape(-1, 3)
    whole, welded = sscc.Detector(f).check(x), sscc.Detector(own, split, weld=True).check(split)
    assert np.array_equal(whole.pairs, welded.pairs)
    for one, two in ((whole, welded), (welded, whole)):
        ends = segments(two.curves())
        for pair, segment in segments(one.curves()).items():
            assert sorted(segment.tolist()) == sorted(ends[pair].tolist())
    assert sorted((len(c.pairs), c.closed) for c in whole.curves()) == sorted(
        (len(c.pairs), c.closed) for c in welded.curves()
    )
    assert any(curve.closed and len(curve.pairs) > 10 for curve in welded.curves())


@pytest.mark.parametrize("is_self", [True, False])
def test_depths_are_the_smallest_translations(is_self: bool) -> None:
    if is_self:
        x, f = folded()
        y, answer = x, sscc.Detector(f).check(x)
    else:
        x, y, f = linked()
        answer = sscc.Detector(f, x).against(x, sscc.Detector(f, y), y)
    depths, directions = answer.depths(), answer.directions()
    assert depths.shape == (answer.count,) and directions.shape == (answer.count, 3) and depths.max() > 0.01
    assert np.allclose(np.linalg.norm(directions, axis=1), 1, rtol=0, atol=1e-15)
    one, other = sscc.Detector(ONE), sscc.Detector(ONE)
    random = np.random.default_rng(0)
    for (i, j), depth, direction in zip(answer.pairs, depths, directions, strict=True):
        def meets(translation: F64, a: F64 = x[f[i]], b: F64 = y[f[j]]) -> bool:
            return one.against(a, other, b + translation).colliding

        assert not meets(direction * depth * (1 + 1e-9))
        shorter = random.normal(size=(4, 3))
        shorter *= depth * (1 - 1e-9) / np.linalg.norm(shorter, axis=1, keepdims=True)
        assert all(meets(translation) for translation in [direction * depth * (1 - 1e-9), *shorter])


def test_pickled_answers_keep_their_contacts() -> None:
    x, y, f = linked()
    folded_x, g = folded()
    detector = sscc.Detector(f, x)
    for answer in (
        detector.against(x, detector, y),
        sscc.Detector(g).check(folded_x),
        sscc.Detector(g).check_many([folded_x])[0],
        pickle.loads(pickle.dumps(sscc.Detector(g).check_many([folded_x, folded_x])))[1],
        detector.check(x),
    ):
        again = pickle.loads(pickle.dumps(answer))
        assert again == answer and np.array_equal(again.depths(), answer.depths())
        curves = zip(answer.curves(), again.curves(), strict=True)
        assert all(a.closed == b.closed and np.array_equal(a.points, b.points) for a, b in curves)


def test_damaged_pickles_are_refused() -> None:
    make: Any = sscc._sscc._detector_answer  # type: ignore[attr-defined]
    answer = sscc.Detector([[0, 1, 2], [3, 4, 5]]).check(np.concatenate([FACE, SPIKE]))
    reduced: Any = answer.__reduce__()
    (((pairs, cost), (triangles, _)),) = reduced[1]
    assert make(((pairs, cost), (triangles, None))) == answer
    nan = triangles[:16] + np.float64(np.nan).tobytes() + triangles[24:]
    contacts: Any
    for contacts in (None, (triangles[:-1], None), (triangles[88:] + triangles[:88], None), (nan, None)):
        with pytest.raises(ValueError, match="the pickled answer is damaged"):
            make(((pairs, cost), contacts))
    with pytest.raises(ValueError, match="the pickled answer is damaged"):
        make(((b"", cost), (triangles, None)))
    # The pickled triangles are not those of the pairs.
    for contacts in ((triangles[:88], None), (triangles, triangles[:88])):
        other = make(((pairs, cost), contacts))
        for call in (other.curves, other.depths, other.directions):
            with pytest.raises(ValueError, match="the pickled answer is damaged"):
                call()


def test_answers_at_q_have_the_contacts_of_their_positions(model: sscc.Model, certs: sscc.Certificates) -> None:
    q = samples(60, 6, 0.6)[np.argmax([certs.check(q).count for q in samples(60, 6, 0.6)])]
    answer = sscc.Detector(model.faces).check(model.positions(q))
    assert np.array_equal(answer.pairs, certs.check(q).pairs) and len(answer.depths()) == answer.count > 0


def test_contacts_stop_on_ctrl_c() -> None:
    """In a fan of triangles around the z axis all pairs cross there."""
    angle = np.linspace(0, np.pi, 1500, endpoint=False)
    round_axis = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    corners = np.stack([round_axis * s + [0, 0, z] for s, z in ((1, 0), (-1, 0.5), (0.5, 2))], axis=1)
    answer = sscc.Detector(np.arange(4500).reshape(-1, 3)).check(corners.reshape(-1, 3))
    assert answer.count == 1500 * 1499 / 2
    for call in (answer.curves, answer.depths, answer.directions):
        assert seconds_until_stopped(call) < MAX_SECONDS
