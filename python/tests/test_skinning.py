"""Modes of linear blend skinning, and animated characters with known answers (models/skinned)."""

from __future__ import annotations

import json
import re
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import sscc
from shapes import torus
from skinned import Character

F64 = NDArray[np.float64]

CHARACTERS = ("Fox", "CesiumMan")


def arm(bones: int) -> tuple[F64, NDArray[np.int64], F64]:
    """Returns a torus, and smooth weights of bones around it."""
    vertices, faces, _ = torus(40, 8, 1)
    angle = np.arctan2(vertices[:, 1], vertices[:, 0])[:, None]
    near = np.cos(angle - 2 * np.pi * np.arange(bones) / bones)
    weights = np.exp(4 * near)
    weights[weights < 1] = 0
    return vertices, faces, weights / weights.sum(axis=1, keepdims=True)


def skin(vertices: F64, weights: F64, matrices: F64) -> F64:
    """Computes linear blend skinning, vertex by vertex."""
    moved = np.einsum("bij,vj->vbi", matrices[:, :3], np.concatenate([vertices, np.ones((len(vertices), 1))], axis=1))
    found: F64 = np.einsum("vb,vbi->vi", weights, moved)
    return found


def poses(count: int, bones: int, scale: float) -> F64:
    """Returns random affine matrices near the identity."""
    random = np.random.default_rng(3)
    matrices = np.tile(np.eye(4), (count, bones, 1, 1))
    matrices[:, :, :3] += random.normal(size=(count, bones, 3, 4)) * scale
    return matrices


def test_q_has_the_documented_order() -> None:
    """q[12 b + 4 i + j] is entry (i, j) of the matrix of bone b minus the identity."""
    x = np.array([[2.0, 3.0, 5.0]])
    modes = sscc.modes.skinning(x, [[0.25, 0.75]])
    assert modes.shape == (1, 3, 24) and modes.dtype == float
    for bone, weight in enumerate((0.25, 0.75)):
        for i in range(3):
            for j, factor in enumerate((2.0, 3.0, 5.0, 1.0)):
                column = modes[0, :, 12 * bone + 4 * i + j]
                assert column.tolist() == [weight * factor if axis == i else 0.0 for axis in range(3)]
    matrices = np.arange(24.0).reshape(2, 3, 4)
    q = sscc.modes.skinning_q(matrices)
    assert q.shape == (24,) and q[12 + 4 * 2 + 1] == matrices[1, 2, 1] and q[12 + 4 * 1 + 1] == matrices[1, 1, 1] - 1
    assert not sscc.modes.skinning_q(np.tile(np.eye(4), (3, 1, 1))).any()


def test_modes_are_linear_blend_skinning() -> None:
    vertices, faces, weights = arm(4)
    model = sscc.Model(vertices, faces, sscc.modes.skinning(vertices, weights))
    assert model.rank == 48
    matrices = poses(20, 4, 0.3)
    qs = sscc.modes.skinning_q(matrices)
    assert qs.shape == (20, 48) and np.array_equal(qs, sscc.modes.skinning_q(matrices[:, :, :3]))
    for q, pose in zip(qs, matrices, strict=True):
        assert np.allclose(model.positions(q), skin(vertices, weights, pose), rtol=0, atol=1e-14)
    # The same motion of all bones is a rigid motion of the mesh.
    turn = np.array([[0.0, -1, 0, 3], [1, 0, 0, -2], [0, 0, 1, 0.5]])
    moved = model.positions(sscc.modes.skinning_q(np.stack([turn] * 4)))
    assert np.allclose(moved, vertices @ turn[:, :3].T + turn[:, 3], rtol=0, atol=1e-14)


def test_answers_are_those_of_the_positions() -> None:
    vertices, faces, weights = arm(4)
    model = sscc.Model(vertices, faces, sscc.modes.skinning(vertices, weights))
    certs = model.certify(epsilon=0.3)
    assert certs.root_radius > 0
    qs = sscc.modes.skinning_q(poses(60, 4, 0.5)) * np.linspace(0.01, 1, 60)[:, None]
    qs = np.concatenate([qs, sscc.modes.skinning_q(poses(20, 4, 1e-3))])
    batch = certs.check_many(qs)
    found = sscc.Detector(faces, vertices).check_many(np.stack([model.positions(q) for q in qs]))
    assert batch.colliding.any() and batch.root_certified.any()
    for answer, expected in zip(batch, found, strict=True):
        assert np.array_equal(answer.pairs, expected.pairs)


def test_weights_are_normalized() -> None:
    vertices, _, weights = arm(3)
    quantized = np.round(weights * 255) / 255
    modes = sscc.modes.skinning(vertices, quantized)
    shift = sscc.modes.skinning_q(np.tile(np.eye(3, 4) + [[0, 0, 0, 1]], (3, 1, 1)))
    assert np.allclose(modes @ shift, 1, rtol=0, atol=1e-14)
    assert np.array_equal(sscc.modes.skinning([[0, 0, 0]], [[1, 0]]), sscc.modes.skinning([[0, 0, 0]], [[0.995, 0]]))


def test_no_vertices_and_no_poses_have_modes_and_q_of_the_usual_shapes() -> None:
    assert sscc.modes.skinning(np.empty((0, 3)), np.empty((0, 2))).shape == (0, 3, 24)
    assert sscc.modes.skinning_q(np.empty((0, 2, 4, 4))).shape == (0, 24)


W = np.full((4, 2), 0.5)
V = np.arange(12.0).reshape(4, 3)
#: Whether long double has more digits than double.
LONG = np.dtype(np.longdouble).itemsize > 8


def put(array: Any, place: Any, value: Any) -> Any:
    changed = array.copy()
    changed[place] = value
    return changed


REFUSED: list[tuple[Any, Any, type[Exception], str]] = [
    (V[:, :2], W, ValueError, "vertices has shape [4, 2]: (V, 3) was expected"),
    (V, W[:3], ValueError, "weights has shape [3, 2]: (4, B) was expected, a row for each vertex"),
    (V, W[:, :0], ValueError, "weights has shape [4, 0]: (4, B) was expected, a row for each vertex"),
    (V, W[0], ValueError, "weights has shape [2]: (4, B) was expected"),
    (V, put(W, (2, 1), np.nan), ValueError, "weights[2, 1] is nan: every weight must be finite"),
    (V, put(W, (2,), [1.5, -0.5]), ValueError, "weights[2, 1] is -0.5: every weight must be at least 0"),
    (V, put(W, (2, 1), 0.6), ValueError, "weights[2] sums to 1.1: 1 was expected; to normalize, pass weights / "),
    (V, W * 0, ValueError, "weights[0] sums to 0: 1 was expected"),
    (V, [[0.5, 0.5], [1]], ValueError, "weights: an array of numbers was expected: "),
    (V, W.astype(complex), TypeError, "weights is an array of complex128: float64, float32 or integers were expected"),
    ("mesh.glb", W, TypeError, "vertices is a str: an array of numbers was expected"),
    (np.ma.masked_array(V), W, TypeError, "vertices is a masked array: fill it first, as by vertices.filled(0)"),
    ([*V[:3], np.ma.masked_array(V[3])], W, TypeError, "vertices is a masked array"),
    *([(V.astype(np.longdouble), W, TypeError, f"vertices is an array of {np.dtype(np.longdouble)}")] if LONG else []),
    (put(V.astype(np.int64), (2, 1), 2**53 + 1), W, ValueError, "vertices: the integer 9007199254740993 is beyond 2^53"),
    (V, [[2**64, 0]] * 4, ValueError, "weights has an integer of more than 64 bits"),
]


@pytest.mark.parametrize(("vertices", "weights", "error", "message"), REFUSED, ids=[m for *_, m in REFUSED])
def test_invalid_weights_are_refused(vertices: Any, weights: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match="^" + re.escape(message)):
        sscc.modes.skinning(vertices, weights)


MATRICES: list[tuple[Any, type[Exception], str]] = [
    (np.eye(4), ValueError, "matrices has shape [4, 4]: (B, 3, 4) or (B, 4, 4) was expected"),
    (np.zeros((2, 4, 3)), ValueError, "matrices has shape [2, 4, 3]: (B, 3, 4) or (B, 4, 4) was expected"),
    (put(np.zeros((2, 3, 4)), (1, 2, 0), np.inf), ValueError, "matrices[1, 2, 0] is inf: every entry must be finite"),
    (np.stack([np.eye(4), np.diag([1, 1, 1, 2.0])]), ValueError, "matrices[1] has the last row [0.0, 0.0, 0.0, 2.0]"),
    (np.zeros((2, 3, 4)).astype(bool), TypeError, "matrices is an array of bool: float64, float32 or integers were"),
]


@pytest.mark.parametrize(("matrices", "error", "message"), MATRICES, ids=[m for *_, m in MATRICES])
def test_invalid_matrices_are_refused(matrices: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match="^" + re.escape(message)):
        sscc.modes.skinning_q(matrices)


@cache
def character(folder: Path, name: str) -> Character:
    return Character.load(folder / f"{name}.glb")


def records(folder: Path, name: str) -> list[dict[str, Any]]:
    """Returns animations with their answers."""
    found: list[dict[str, Any]] = json.loads((folder / f"{name}.answers.json").read_text())
    return found


@pytest.mark.parametrize("name", CHARACTERS)
def test_characters_have_exactly_the_known_pairs(name: str, models: Path) -> None:
    """Positions of every stored frame come from skinning bone by bone. The detector welds vertices by classes."""
    played = character(models / "skinned", name)
    vertices, faces, _ = played.mesh
    detector = sscc.Detector(faces, vertices, weld=played.classes)
    for record in records(models / "skinned", name):
        times = [frame["time"] for frame in record["frames"]]
        frames = np.stack([played.positions(played.bones(record["animation"], time)) for time in times])
        found = detector.check_many(frames, progress=False)
        for frame, answer in zip(record["frames"], found, strict=True):
            assert answer.pairs.tolist() == frame["pairs"], (name, frame["time"])


@pytest.mark.parametrize("name", CHARACTERS)
def test_skinning_modes_have_exactly_the_known_pairs(name: str, models: Path) -> None:
    """Positions of every stored frame are `vertices + U q`, in double precision."""
    played = character(models / "skinned", name)
    vertices, faces, weights = played.mesh
    model = sscc.Model(vertices, faces, sscc.modes.skinning(vertices, weights))
    detector = sscc.Detector(faces, weld=played.classes)
    for record in records(models / "skinned", name):
        for frame in record["frames"]:
            bones = played.bones(record["animation"], frame["time"])
            positions = model.positions(sscc.modes.skinning_q(bones))
            assert np.allclose(positions, played.positions(bones), rtol=0, atol=1e-6 * np.ptp(positions))
            assert detector.check(positions).pairs.tolist() == frame["pairs"], (name, frame["time"])


def test_certificates_of_a_character_are_exact(models: Path) -> None:
    """For the model Fox, the root proves few poses free, but all answers are exact."""
    played = character(models / "skinned", "Fox")
    vertices, faces, weights = played.mesh
    model = sscc.Model(vertices, faces, sscc.modes.skinning(vertices, weights))
    certs = model.certify(weld=True, epsilon=0.5, progress=False)
    for record in records(models / "skinned", "Fox"):
        qs = [sscc.modes.skinning_q(played.bones(record["animation"], frame["time"])) for frame in record["frames"]]
        for frame, answer in zip(record["frames"], certs.check_many(np.stack(qs), progress=False), strict=True):
            assert answer.pairs.tolist() == frame["pairs"], frame["time"]
