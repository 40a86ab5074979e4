"""Detectors: exact collisions of any mesh at given positions."""

from __future__ import annotations

import copy
import multiprocessing
import pickle
import re
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import exact
import sscc
from first_contact import Pair, mixed
from polynomial import rational
from shapes import samples, torus, two_triangles
from test_continuous import candidates, coarse_torus, contact, is_close, moving
from test_interrupt import MAX_SECONDS, ctrl_c_handler, seconds_until_stopped  # noqa: F401

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]
U32 = NDArray[np.uint32]

X, FACES, _ = two_triangles()
#: The upper triangle falls through the lower one.
FALLEN = X * [1, 1, -1]


def soup(count: int, random: np.random.Generator) -> tuple[F64, I64]:
    """Returns random triangles in the unit cube, about 0.3 in size."""
    centres = random.uniform(size=(count, 1, 3))
    corners = centres + random.uniform(-0.15, 0.15, size=(count, 3, 3))
    return corners.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3)


def lattice_soup(count: int, random: np.random.Generator) -> tuple[F64, I64]:
    """Returns triangles with corners in a lattice of 4 x 4 x 4 points, each with its own vertices: many touch, are coplanar,
    equal or of zero area."""
    return random.integers(0, 4, size=(3 * count, 3)).astype(float), np.arange(3 * count).reshape(-1, 3)


def brute_force(corners: F64) -> list[list[int]]:
    """Returns all pairs of triangles that have a common point, by rational arithmetic. corners: (F, 3, 3)."""
    start = rational(Fraction(0))
    found = []
    for i in range(len(corners)):
        for j in range(i + 1, len(corners)):
            pair = Pair(np.stack([corners[[i, j]], corners[[i, j]]], axis=1))
            if any(pair.is_partition(some, start) for some in mixed(range(6), 5)):
                found.append([i, j])
    return found


def test_one_line_finds_self_intersections() -> None:
    assert sscc.self_intersections(X, FACES).tolist() == []
    touching = X * [1, 1, 0] + [0.1, 0, 0] * (np.arange(6) > 2)[:, None]
    pairs = sscc.self_intersections(touching, FACES)
    assert pairs.tolist() == [[0, 1]] and pairs.dtype == np.uint32 and pairs.shape == (1, 2)
    assert sscc.self_intersections(touching.tolist(), FACES.tolist()).tolist() == [[0, 1]]
    assert sscc.self_intersections(touching.astype("f4"), np.asfortranarray(FACES, "u1")).tolist() == [[0, 1]]
    vertices: Any
    faces: Any
    for vertices, faces in [(X, FACES[:0]), (X, []), ([], []), (X[:0], np.zeros((0, 3), int))]:
        none = sscc.self_intersections(vertices, faces)
        assert none.shape == (0, 2) and none.dtype == np.uint32
    assert sscc.self_intersections(X, FACES[:1]).shape == (0, 2)


def test_the_contact_filter() -> None:
    """Two triangles meet in a corner, and each has its own vertex there. When folded, they also meet beside it."""
    flat = np.array([[0, 0, 0], [2, -1, 0], [2, 1, 0], [0, 0, 0], [1, 0, 1], [2, 0, 1]], float)
    folded = flat * [1, 1, 0]
    find: Callable[..., U32] = sscc.self_intersections
    assert find(flat, FACES).tolist() == find(folded, FACES).tolist() == [[0, 1]]
    for weld in (True, [0, 1, 2, 0, 4, 5], np.array([7, -1, 3, 7, 5, 6])):
        assert find(flat, FACES, weld=weld).tolist() == find(folded, FACES, weld=weld).tolist() == []
        strict = {"weld": weld, "neighbours": "include-one-vertex"}
        assert find(flat, FACES, **strict).tolist() == []
        assert find(folded, FACES, **strict).tolist() == [[0, 1]]
        detector = sscc.Detector(FACES, flat, weld=weld, neighbours="include-one-vertex")
        assert detector.check(folded).count == 1 and detector.check(flat).count == 0
    for ignored in ([[0, 1]], np.array([[1, 0], [0, 0], [0, 1]], "i2")):
        detector = sscc.Detector(FACES, ignored=ignored)
        assert not detector.check(folded).colliding and detector.ignored.tolist() == [[0, 1]]


def test_folded_neighbours_and_doubled_faces_are_found_on_request() -> None:
    """The mesh has a triangle folded onto its neighbour, an open hinge, and a doubled face."""
    faces = [[0, 1, 2], [1, 0, 3], [0, 4, 1], [2, 0, 1]]
    closed = np.array([[0, 0, 0], [2, 0, 0], [0, 2, 0], [0.5, 0.5, 0], [0, -1, 1]], float)
    opened = closed + np.array([[0], [0], [0], [1], [0]]) * [0, 0, 1]
    assert sscc.self_intersections(closed, faces).tolist() == []
    assert sscc.self_intersections(closed, faces, neighbours="include-one-vertex").tolist() == []
    assert sscc.self_intersections(closed, faces, neighbours="include-folded").tolist() == [[0, 1], [0, 3], [1, 3]]
    detector = sscc.Detector(faces, neighbours="include-folded")
    assert [answer.count for answer in detector.check_many(np.array([closed, opened]))] == [3, 1]
    with pytest.raises(ValueError, match="include-folded is for discrete queries of meshes without modes"):
        detector.continuous(opened, closed)


@pytest.mark.parametrize("seed", range(4))
def test_pairs_equal_brute_force(seed: int) -> None:
    random = np.random.default_rng(seed)
    vertices, faces = lattice_soup(25, random)
    expected = brute_force(vertices[faces])
    assert len(expected) > 20
    assert sscc.self_intersections(vertices, faces).tolist() == expected
    assert sscc.Detector(faces).check(vertices).pairs.tolist() == expected
    # Vertices of equal position are welded.
    unique, numbers = np.unique(vertices, axis=0, return_inverse=True)
    joined = numbers.reshape(-1)[faces]
    apart = [[i, j] for i, j in expected if not set(joined[i]) & set(joined[j])]
    assert 0 < len(apart) < len(expected)
    assert sscc.self_intersections(vertices, faces, weld=True).tolist() == apart
    assert sscc.self_intersections(unique, joined).tolist() == apart


def check_against_libigl(positions: F64, faces: I64, found: U32) -> int:
    """Checks that the pairs are those of libigl and contacts at coincident vertices. Returns the number of these contacts."""
    wrong, at_coincident = exact.unexplained(positions, faces, found, exact.libigl_pairs(positions, faces))
    assert not wrong, "\n".join(wrong)
    return at_coincident


@pytest.mark.usefixtures("libigl")
@pytest.mark.parametrize("seed", range(5))
def test_soups_equal_libigl(seed: int) -> None:
    random = np.random.default_rng(seed)
    vertices, faces = soup(500, random)
    pairs = sscc.self_intersections(vertices, faces)
    assert len(pairs) > 100 and check_against_libigl(vertices, faces, pairs) == 0
    frames = vertices * random.uniform(0.2, 1.5, size=(6, 1, 3)) + random.normal(size=(6, len(vertices), 3)) * 0.1
    for frame, answer in zip(frames, sscc.Detector(faces, vertices).check_many(frames), strict=True):
        assert answer.count > 0 and check_against_libigl(frame, faces, answer.pairs) == 0


@pytest.mark.usefixtures("libigl")
def test_libigl_omits_contacts_at_coincident_vertices() -> None:
    """The triangles of the torus have their own vertices: neighbours touch, and count."""
    x, f, modes = torus(24, 12, 6)
    for q in samples(5, 6, 0.4):
        split, faces = (x + modes @ q)[f].reshape(-1, 3), np.arange(3 * len(f)).reshape(-1, 3)
        pairs = sscc.self_intersections(split, faces)
        assert check_against_libigl(split, faces, pairs) > 3000
        welded = sscc.self_intersections(split, faces, weld=True)
        assert np.array_equal(welded, sscc.self_intersections(x + modes @ q, f))
        assert {tuple(pair) for pair in welded.tolist()} <= {tuple(pair) for pair in pairs.tolist()}


@pytest.mark.usefixtures("libigl")
def test_cloth_frames_equal_libigl(models: Path) -> None:
    files = sorted((models / "ccd_frames").rglob("*.ply"))
    meshes = [sscc.modes.polynomial(file) for file in files]
    assert len(meshes) >= 2
    faces = meshes[0].faces.astype(np.int64)
    frames = np.stack([mesh.vertices for mesh in meshes])
    for frame, answer in zip(frames, sscc.Detector(faces).check_many(frames), strict=True):
        assert answer.count > 200 and check_against_libigl(frame, faces, answer.pairs) == 0


@pytest.mark.usefixtures("libigl")
@pytest.mark.parametrize("name", exact.MODELS)
def test_random_poses_equal_libigl_and_certificates(name: str, models: Path) -> None:
    """Compares poses of `test_exact.py`, where certificates and libigl agree. Only a few are compared with libigl here."""
    model = exact.load(name, models)
    qs = exact.configurations(model, exact.COUNT, exact.MODELS[name])
    faces = model.faces.astype(np.int64)
    detector = sscc.Detector(faces, model.vertices)
    certs = exact.certificates(name, models)
    few = range(0, exact.COMPARED, 50)
    for start in few:
        part = qs[start : min(start + 50, exact.COMPARED)]
        found = detector.check_many(np.stack([model.positions(q) for q in part]), progress=False)
        for answer, expected in zip(found, certs.check_many(part, progress=False), strict=True):
            assert np.array_equal(answer.pairs, expected.pairs)
    positions = [model.positions(qs[i]) for i in few]
    answers = exact.libigl_answers((x, faces) for x in positions)
    for x, expected_pairs in zip(positions, answers, strict=True):
        assert np.array_equal(detector.check(x).pairs, expected_pairs)


def test_two_meshes_equal_one_that_has_both() -> None:
    random = np.random.default_rng(5)
    x, f = soup(300, random)
    y, g = soup(200, random)
    assert len(sscc.self_intersections(x, f)) > 0
    pairs = sscc.self_intersections(np.concatenate([x, y]), np.concatenate([f, g + len(x)]))
    between = [[i, j - 300] for i, j in pairs.tolist() if i < 300 <= j]
    first, second = sscc.Detector(f, x), sscc.Detector(g)
    answer = first.against(x, second, y)
    assert answer.pairs.tolist() == between and answer.count == len(between) > 50 and answer.complete
    assert sorted([j, i] for i, j in second.against(y, first, x).pairs.tolist()) == sorted(between)
    # A mesh is tested against itself at other positions.
    assert first.against(x, first, x).count > 300
    moved = first.against_continuous(x, x + [3, 0, 0], second, y + [3, 0, 0], y)
    resting = first.against_continuous(x, x, second, y, y)
    assert resting.pairs.tolist() == between and not resting.times.any()
    assert moved.count > len(between) and 0 <= moved.times.min() <= moved.times.max() <= 1


def test_continuous_queries_return_times() -> None:
    detector = sscc.Detector(FACES, X)
    impacts = detector.continuous(X, FALLEN)
    assert impacts.colliding and impacts.count == 1 and impacts.pairs.tolist() == [[0, 1]] and impacts.complete
    assert 0.5 - 1e-9 <= impacts.times[0] <= 0.5 and impacts.time_of_impact == impacts.times[0]
    free = detector.continuous(X, X + [0, 0, 1])
    assert not free.colliding and free.time_of_impact is None and free.times.shape == (0,)
    lower, upper = sscc.Detector(FACES[:1], X), sscc.Detector(FACES[:1], X[3:])
    met = lower.against_continuous(X, X, upper, X[3:], FALLEN[3:])
    assert met.pairs.tolist() == [[0, 0]] and 0.5 - 1e-9 <= met.times[0] <= 0.5


def test_continuous_queries_equal_exact_arithmetic() -> None:
    model = coarse_torus(8, 5, 3)
    q0, q1 = np.round(samples(2, 3, 0.5, seed=4) * 32) / 32
    corners = moving(model, q0, q1)
    found = sscc.Detector(model.faces).continuous(model.positions(q0), model.positions(q1))
    times = {(i, j): t for (i, j), t in zip(found.pairs.tolist(), found.times.tolist(), strict=True)}
    near = list(candidates(corners, model.faces))
    assert set(times) <= set(near) and len(times) > 5
    random = np.random.default_rng(1)
    others = [pair for pair in near if pair not in times]
    for i, j in [*times, *random.permutation(np.array(others))[:15].tolist()]:
        when = contact(corners, i, j)
        if when is not None:
            assert times[i, j] <= when + 2.0**-48
        elif (i, j) in times:
            assert is_close(corners, i, j, times[i, j])


def test_limits_end_the_search() -> None:
    x, f = soup(200, np.random.default_rng(2))
    detector = sscc.Detector(f, x)
    whole = detector.check(x)
    some, one = detector.check(x, 3), detector.check(x, first=True)
    assert (some.count, some.complete, one.count, one.complete) == (3, False, 1, False)
    assert one.colliding and detector.check(x, limit=1) == detector.check(x, 1, first=True)
    assert {tuple(pair) for pair in some.pairs} <= {tuple(pair) for pair in whole.pairs}
    apart = x.reshape(-1, 3, 3) + np.arange(200)[:, None, None]
    free = detector.check(apart.reshape(-1, 3), first=True)
    assert free.complete and not free.colliding
    assert whole.complete and whole.box_tests > 0 and whole.triangle_tests > 0 and whole.opened > 0
    batch = detector.check_many([x, apart.reshape(-1, 3)], 2)
    assert batch.count.tolist() == [2, 0] and batch.complete.tolist() == [False, True]


def test_batches_equal_single_answers() -> None:
    x, f, modes = torus(24, 12, 6)
    frames = x + np.einsum("var,tr->tva", modes, samples(40, 6, 0.3))
    detector = sscc.Detector(f)
    batch = detector.check_many(frames, threads=2)
    assert len(batch) == 40 and batch == detector.check_many(list(frames), threads=1)
    assert batch != detector.check_many(frames[:39]) and batch != detector.check_many(frames[::-1])
    for t, answer in enumerate(batch):
        assert answer == detector.check(frames[t])
        assert np.array_equal(batch.pairs[batch.offsets[t] : batch.offsets[t + 1]], answer.pairs)
        assert np.array_equal(answer.pairs, sscc.self_intersections(frames[t], f))
    assert 0 < batch.colliding.sum() < 40 and np.array_equal(batch.count, np.diff(batch.offsets))
    assert batch.complete.all() and batch.box_tests.all() and batch.tree_cost.all()
    assert batch.opened.sum() > 0 and batch.triangle_tests.sum() > 0
    assert batch[-1] == batch[39]
    with pytest.raises(IndexError, match="40 answers"):
        batch[40]
    empty = detector.check_many(np.zeros((0, 288, 3)))
    assert len(empty) == 0 and empty.pairs.shape == (0, 2) and empty.offsets.tolist() == [0]
    assert len(sscc.Detector(f).check_many(np.zeros((0, 288, 3)))) == 0


def test_a_degraded_hierarchy_is_rebuilt() -> None:
    random = np.random.default_rng(8)
    x, f = soup(2000, random)
    detector = sscc.Detector(f, x)
    assert detector.check(x).rebuilds == 0
    mixed_up = x.reshape(-1, 9)[random.permutation(2000)].reshape(-1, 3)
    before = detector.check(mixed_up)
    assert before.rebuilds == 1 and before.tree_cost > 0
    assert before == sscc.Detector(f, mixed_up).check(mixed_up) and detector.check(mixed_up).rebuilds == 1


def test_attributes_and_representations() -> None:
    assert repr(sscc.Detector(FACES)) == "<sscc.Detector: 2 triangles, positions not yet known>"
    detector = sscc.Detector(FACES, X.astype("f4"), neighbours="include-one-vertex")
    assert repr(detector) == "<sscc.Detector: 2 triangles, 6 vertices>"
    assert np.array_equal(detector.faces, FACES) and detector.faces.dtype == np.uint32
    assert detector.rest is not None and np.array_equal(detector.rest, X) and detector.rest.dtype == float
    assert detector.neighbours == "include-one-vertex" and detector.weld is False
    assert sscc.Detector(FACES, X, weld=True).weld is True and detector.ignored.shape == (0, 2)
    late = sscc.Detector(FACES, weld=[9, 1, 1, 4, 5, 6])
    assert late.rest is None and np.asarray(late.weld).tolist() == [4, 0, 0, 1, 2, 3]
    assert not late.check(X).colliding and late.rest is None
    assert repr(late) == "<sscc.Detector: 2 triangles, 6 vertices>"
    flat = X * [1, 1, 0]
    assert repr(detector.check(X)) == "<sscc.DetectorAnswer: free>"
    assert repr(detector.check(flat)) == "<sscc.DetectorAnswer: colliding, 1 pair>"
    crossing, three = soup(200, np.random.default_rng(2))
    assert repr(sscc.Detector(three).check(crossing, 3)) == "<sscc.DetectorAnswer: colliding, at least 3 pairs>"
    assert repr(detector.check_many([X, flat])) == "<sscc.DetectorBatch: 2 answers, 1 colliding>"
    assert repr(detector.continuous(X, X)) == "<sscc.DetectorImpacts: free from start to end>"
    assert repr(detector.continuous(X, FALLEN)) == "<sscc.DetectorImpacts: 1 pair, the first at 0.5000>"
    for result in (detector.check(X), detector.continuous(X, X)):
        with pytest.raises(TypeError, match=r"use \.colliding"):
            bool(result)
    answer = detector.check(flat)
    assert answer.pairs is answer.pairs
    with pytest.raises(ValueError, match="read-only"):
        answer.pairs[0, 0] = 1


def test_pickles() -> None:
    x, f = soup(100, np.random.default_rng(3))
    options: Any
    for options in ({}, {"rest": x}, {"rest": x, "weld": True}, {"weld": np.arange(300) // 2, "ignored": [[0, 1]]}):
        detector = sscc.Detector(f, **options)
        for again in (pickle.loads(pickle.dumps(detector)), copy.deepcopy(detector)):
            assert type(again) is sscc.Detector
            assert again.check(x) == detector.check(x)
            for name in ("faces", "rest", "weld", "ignored", "neighbours"):
                assert np.array_equal(getattr(again, name), getattr(detector, name)), name
    detector = sscc.Detector(f, x)
    for result in (detector.check(x), detector.check_many([x, x + x]), detector.continuous(x, -x)):
        again = pickle.loads(pickle.dumps(result))
        assert again == result and type(again) is type(result) and np.array_equal(again.pairs, result.pairs)
        assert pickle.dumps(again) == pickle.dumps(result)
    for name in ("_detector_answer", "_detector_batch", "_detector_impacts"):
        with pytest.raises((TypeError, ValueError)):
            getattr(sscc._sscc, name)(b"x")
    with pytest.raises(ValueError, match="damaged"):
        make: Any = sscc._sscc._detector_answer  # type: ignore[attr-defined]
        make(((b"xyz", (True, 0, 0, 0, 0.0, 0)), None))


def pairs_of(detector: sscc.Detector, frames: F64) -> list[Any]:
    return [answer.pairs.tolist() for answer in detector.check_many(frames, threads=1)]


def test_other_processes_give_the_same_answers() -> None:
    x, f = soup(100, np.random.default_rng(3))
    frames = x * np.linspace(0.5, 1, 6)[:, None, None]
    detector = sscc.Detector(f)
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        found = pool.apply(pairs_of, (detector, frames))
    assert found == pairs_of(detector, frames)


def test_eight_threads_get_the_same_answers() -> None:
    x, f = soup(300, np.random.default_rng(4))
    frames = x * np.linspace(0.3, 1.5, 24)[:, None, None]
    expected = [sscc.self_intersections(frame, f).tolist() for frame in frames]
    motions = [sscc.Detector(f, x).continuous(frame, x) for frame in frames[:6]]
    between = [sscc.Detector(f, x).against(frame, sscc.Detector(f, x), x) for frame in frames[:6]]
    detector = sscc.Detector(f)  # the first thread builds the hierarchy
    start = threading.Barrier(8)

    def ask(thread: int) -> None:
        start.wait()
        for i in range(len(frames)):
            i = (i + 3 * thread) % len(frames)
            assert detector.check(frames[i]).pairs.tolist() == expected[i]
            if i < len(motions):
                assert detector.continuous(frames[i], x) == motions[i]
                assert detector.against(frames[i], detector, x) == between[i]
        assert pairs_of(detector, frames) == expected

    with ThreadPoolExecutor(8) as pool:
        for outcome in [pool.submit(ask, thread) for thread in range(8)]:
            outcome.result()


def test_later_writes_to_an_array_change_no_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    detector = sscc.Detector(FACES, X)
    flat = X * [1, 1, 0]
    frames = np.stack([flat] * 50)

    def overwrite(_progress: object, _label: str) -> None:
        frames[:] = X

    monkeypatch.setattr(sscc._progress, "start", overwrite)
    assert detector.check_many(frames).colliding.all() and np.array_equal(frames[7], X)


def test_calls_release_the_gil() -> None:
    """Another thread counts during the calls."""
    x, f = soup(20_000, np.random.default_rng(6))
    counted, done = 0, threading.Event()

    def count() -> None:
        nonlocal counted
        while not done.wait(0.001):
            counted += 1

    counter = threading.Thread(target=count)
    counter.start()
    detector = sscc.Detector(f, x)
    detector.check(x)
    detector.check_many(np.stack([x] * 4), threads=1)
    done.set()
    counter.join()
    assert counted > 10


def test_long_calls_stop_on_ctrl_c() -> None:
    """All triangles are one point, so each pair collides, and queries take minutes."""
    vertices, faces, _ = torus(90, 45, 1)
    point = vertices * 0
    detector, other = sscc.Detector(faces, vertices), sscc.Detector(faces, vertices)
    calls: list[Callable[[], object]] = [
        lambda: sscc.self_intersections(np.zeros((30_000, 3)), np.arange(30_000).reshape(-1, 3)),
        lambda: detector.check(point),
        lambda: detector.check_many(np.stack([point] * 4)),
        lambda: detector.continuous(point, point),
        lambda: detector.against(point, other, point),
        lambda: detector.against_continuous(point, point, other, point, point),
    ]
    for call in calls:
        assert seconds_until_stopped(call) < MAX_SECONDS
    with pytest.raises(ZeroDivisionError):
        detector.check_many(np.stack([vertices] * 50 + [point]), progress=lambda share: 1 / 0)
    assert not detector.check(vertices).colliding and not other.check(vertices).colliding


def test_progress_ascends_to_one() -> None:
    shares: list[float] = []
    sscc.Detector(FACES).check_many(np.stack([X] * 100), progress=shares.append)
    assert shares[-1] == 1.0 and shares == sorted(shares)


def put(array: Any, place: Any, value: Any) -> Any:
    changed = array.copy()
    changed[place] = value
    return changed


NAN, LARGE = put(X, (4, 1), np.nan), put(X, (4, 1), -1e80)
POSITIONS: list[tuple[Any, type[Exception], str]] = [
    (X[:, :2], ValueError, "{} has shape [6, 2]: (V, 3) was expected"),
    (X.ravel(), ValueError, "{} has shape [18]: (V, 3) was expected"),
    (1.0, ValueError, "{} has shape []: (V, 3) was expected"),
    (NAN, ValueError, "{}: vertex 4 (counted from 0) has the position [1.0, NaN, 1.0]: not finite, or beyond 2^200"),
    (put(X, (4, 1), np.inf), ValueError, "{}: vertex 4 (counted from 0) has the position"),
    (LARGE, ValueError, "{}: vertex 4 (counted from 0) has the position"),
    (X.astype(complex), TypeError, "{} is an array of complex128: float64, float32 or integers were expected"),
    (X.astype(bool), TypeError, "{} is an array of bool"),
    (None, TypeError, "{} is a NoneType: an array of numbers was expected"),
    ("x.obj", TypeError, "{} is a str: an array of numbers was expected"),
    ([[0, 0, 0], [1, 1]], ValueError, "{}: an array of numbers was expected: "),
    (np.ma.masked_array(X), TypeError, "{} is a masked array: fill it first"),
]
OTHER_MESH = (X[:5], ValueError, "{}: there are 5 positions, but the mesh has 6 vertices: are they of another mesh?")


def check_refused(call: Callable[[], object], error: type[Exception], message: str) -> None:
    with pytest.raises(error, match="^" + re.escape(message)) as raised:
        call()
    assert "\n" not in str(raised.value) or "inhomogeneous" in str(raised.value)


@pytest.mark.parametrize(("x", "error", "message"), [*POSITIONS, OTHER_MESH])
def test_invalid_positions_are_refused(x: Any, error: type[Exception], message: str) -> None:
    one, two = sscc.Detector(FACES, X), sscc.Detector(FACES, X)
    calls: list[tuple[str, Callable[[], object]]] = [
        ("positions", lambda: one.check(x)),
        ("x0", lambda: one.continuous(x, X)),
        ("x1", lambda: one.continuous(X, x)),
        ("positions", lambda: one.against(x, two, X)),
        ("other_positions", lambda: one.against(X, two, x)),
        ("x0", lambda: one.against_continuous(x, X, two, X, X)),
        ("x1", lambda: one.against_continuous(X, x, two, X, X)),
        ("y0", lambda: one.against_continuous(X, X, two, x, X)),
        ("y1", lambda: one.against_continuous(X, X, two, X, x)),
    ]
    for name, call in calls:
        check_refused(call, error, message.format(name))
    assert not one.check(X).colliding


@pytest.mark.parametrize(("x", "error", "message"), POSITIONS)
def test_invalid_first_positions_are_refused(x: Any, error: type[Exception], message: str) -> None:
    check_refused(lambda: sscc.self_intersections(x, FACES), error, message.format("vertices"))
    if x is not None:
        check_refused(lambda: sscc.Detector(FACES, x), error, message.format("rest"))
    late = sscc.Detector(FACES)
    check_refused(lambda: late.check(x), error, message.format("positions"))
    assert not late.check(X).colliding


def test_first_positions_must_have_the_vertices_of_the_faces() -> None:
    late = sscc.Detector(FACES)
    message = "positions: triangle 1 (counted from 0) names vertex 5, but there are 5"
    check_refused(lambda: late.check(X[:5]), ValueError, message)
    message = "frames[0]: triangle 1 (counted from 0) names vertex 5, but there are 5"
    check_refused(lambda: late.check_many(X[None, :5]), ValueError, message)
    classes = sscc.Detector(FACES, weld=np.arange(7))
    check_refused(lambda: classes.check(X), ValueError, "weld has 7 entries, but positions has 6 vertices")
    # The first positions may have unused vertices, and set their number.
    assert not late.check(np.concatenate([X, X])).colliding
    check_refused(lambda: late.check(X), ValueError, "positions: there are 6 positions, but the mesh has 12")


RULES = "'exclude' or 'include-one-vertex' or 'include-folded'"

ARGUMENTS: list[tuple[dict[str, Any], type[Exception], str]] = [
    ({"faces": FACES[:, :2]}, ValueError, "faces has shape [2, 2]: (F, 3) was expected"),
    ({"faces": FACES.astype(float)}, TypeError, "faces is an array of float64: integers were expected"),
    ({"faces": put(FACES, (1, 1), 6)}, ValueError, "faces[1] names vertex 6: {} has 6, counted from 0"),
    ({"faces": put(FACES, (1, 1), -1)}, ValueError, "faces[1] names vertex -1: {} has 6, counted from 0"),
    ({"faces": put(FACES, (1, 1), 2**40)}, ValueError, f"faces[1] names vertex {2**40}: {{}} has 6"),
    ({"faces": np.full((1, 3), 2**63, np.uint64)}, ValueError, f"faces: {2**63} is too large"),
    ({"faces": None}, TypeError, "faces is a NoneType: an array of numbers was expected"),
    ({"weld": "on"}, TypeError, "weld is a str: True, False or (V,) integers were expected"),
    ({"weld": 1}, ValueError, "weld has shape []: True, False or (V,) integers were expected"),
    ({"weld": [0.5] * 6}, TypeError, "weld is an array of float64: integers were expected"),
    ({"weld": [0] * 5}, ValueError, "weld has 5 entries, but {} has 6 vertices"),
    ({"neighbours": "all"}, ValueError, f"neighbours is 'all': {RULES} was expected"),
    ({"neighbours": 1}, TypeError, f"neighbours is a int: {RULES} was expected"),
]


@pytest.mark.parametrize(("changed", "error", "message"), ARGUMENTS)
def test_invalid_arguments_are_refused(changed: dict[str, Any], error: type[Exception], message: str) -> None:
    arguments = {"faces": FACES, **changed}
    check_refused(lambda: sscc.Detector(rest=X, **arguments), error, message.format("rest"))
    check_refused(lambda: sscc.self_intersections(X, **arguments), error, message.format("vertices"))


def test_invalid_options_are_refused() -> None:
    detector = sscc.Detector(FACES, X)
    refused: list[tuple[Callable[[], object], type[Exception], str]] = [
        (lambda: sscc.Detector(FACES[:0]), ValueError, "faces: the mesh has no triangles"),
        (lambda: sscc.Detector([]), ValueError, "faces: the mesh has no triangles"),
        (lambda: sscc.Detector([[0, 1, -2]]), ValueError, "faces[0] names vertex -2: a number from 0 to 2^32 - 2"),
        (lambda: sscc.Detector(FACES, weld=True), ValueError, "weld is True, but rest is missing"),
        (lambda: sscc.Detector(FACES, ignored=[0, 1]), ValueError, "ignored has shape [2]: (n, 2) was expected"),
        (lambda: sscc.Detector(FACES, ignored=[[0, 1], [0, 2]]), ValueError, "ignored[1] names triangle 2: faces has"),
        (lambda: sscc.Detector(FACES, ignored=[[-1, 1]]), ValueError, "ignored[0] names triangle -1: faces has 2"),
        (lambda: sscc.self_intersections(NAN, []), ValueError, "vertices: vertex 4 (counted from 0) has the pos"),
        (lambda: detector.check(X, 0), ValueError, "limit is 0: a whole number of at least 1 was expected"),
        (lambda: detector.check(X, 1.5), TypeError, "limit is a float: a whole number"),  # type: ignore[arg-type]
        (lambda: detector.check(X, 2, first=True), ValueError, "first is True and limit is 2: leave one of them out"),
        (lambda: detector.check(X, first=1), TypeError, "first is a int: True or False"),  # type: ignore[arg-type]
        (lambda: detector.check_many(X), ValueError, "frames has shape [6, 3]: (T, 6, 3) was expected; for one frame"),
        (lambda: detector.check_many(X[None, :5]), ValueError, "frames has shape [1, 5, 3]: (T, 6, 3) was expected"),
        (lambda: sscc.Detector(FACES).check_many(X), ValueError, "frames has shape [6, 3]: (T, V, 3) was expected"),
        (lambda: detector.check_many([X, NAN]), ValueError, "frames[1]: vertex 4 (counted from 0) has the position"),
        (lambda: detector.check_many([X, X, LARGE, NAN]), ValueError, "frames[2]: vertex 4 (counted from 0)"),
        (lambda: sscc.Detector(FACES).check_many([NAN]), ValueError, "frames[0]: vertex 4 (counted from 0)"),
        (lambda: detector.check_many([X], threads=0), ValueError, "threads is 0: a whole number from 1 to 1024"),
        (lambda: detector.check_many([X], progress=3), TypeError, "progress is a int"),  # type: ignore[arg-type]
        (lambda: detector.against(X, X, X), TypeError, "other is a ndarray: a sscc.Detector was"),  # type: ignore[arg-type]
    ]
    for call, error, message in refused:
        check_refused(call, error, message)


def test_frames_without_vertices_take_no_memory() -> None:
    shape = "frames has shape [1099511627776, 0, 3]: "
    for detector, expected in [
        (sscc.Detector(FACES), "at least one vertex was expected"),
        (sscc.Detector(FACES, X), "(T, 6, 3) was expected"),
    ]:
        check_refused(lambda: detector.check_many(np.empty((2**40, 0, 3))), ValueError, shape + expected)
    assert len(sscc.Detector(FACES).check_many(np.empty((0, 2**40, 3)))) == 0


def test_bodies_share_a_volume() -> None:
    corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
    quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    faces = [triangle for a, b, c, d in quads for triangle in ([a, b, c], [a, c, d])]
    box = sscc.Detector(faces)
    found = box.penetration(corners, sscc.Detector(faces), corners + [0.75, 0.5, 0])
    assert abs(found.volume - 0.125) <= found.volume_error < 1e-11
    assert found.depth <= 0.25 <= found.depth + found.depth_error + 1e-8
    assert box.penetration(corners, box, corners + 2) == (0, 0, 0, 0)
    with pytest.raises(ValueError, match="the second mesh has no inside"):
        box.penetration(corners, sscc.Detector(faces[1:]), corners)


def test_near_pairs_and_the_nearest_one() -> None:
    detector = sscc.Detector([[0, 1, 2], [3, 4, 5]], X)
    pairs, distances = detector.within(X, 1.5)
    assert (pairs.tolist(), distances.tolist()) == ([[0, 1]], [1.0])
    assert not pairs.flags.writeable and not distances.flags.writeable
    assert detector.within(X, 1.0)[0].shape == (0, 2)
    assert detector.nearest(X) == (1.0, (0, 1))
    assert detector.nearest(FALLEN, rings=np.int64(3)) == (1.0, (0, 1))
    other = sscc.Detector([[0, 1, 2]])
    far = X[:3] + [0, 0, 9]
    assert detector.nearest_against(X, other, far) == (8.0, (1, 0))
    assert detector.within_against(X, other, far, 8.5)[0].tolist() == [[1, 0]]
    assert detector.enclosed(X, other, far) == ((0, 2), (0, 1))
    for bad in [0, -1, float("inf"), float("nan")]:
        with pytest.raises(ValueError, match="clearance"):
            detector.within(X, bad)
    with pytest.raises(TypeError, match="clearance is a str"):
        detector.within(X, "1")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="rings is 0"):
        detector.nearest(X, rings=0)
