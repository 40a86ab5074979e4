"""Configurations of real models, and their self-intersections by libigl's exact predicates."""

from __future__ import annotations

import multiprocessing
import os
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import sscc

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]
U32 = NDArray[np.uint32]

#: Models without vertices of equal position (libigl omits pairs that touch at such vertices). The number is the largest
#: displacement of their configurations in half diagonals of their AABB, such that many of them collide.
MODELS = {"vega_A": 8.0, "bunny": 4.0, "face": 0.2}
#: Number of configurations of each model, and number of those to compare: all with CI=true, else the first eighth.
COUNT = 500
COMPARED = COUNT if os.environ.get("CI") == "true" else COUNT // 8


@cache
def load(name: str, models: Path) -> sscc.Model:
    """Returns the model of that name."""
    match name:
        case "vega_A":
            return sscc.Model.load(models / "vega_A/A.obj", models / "vega_A/A.URendering.float")
        case "bunny":
            return sscc.modes.polynomial(models / "bunny_14964_closed.obj")
        case "face":
            folder = models / "ict_face"
            return sscc.Model.load(folder / "ict_face_neutral.obj", folder / "ict_face_expressions30.U.float")
    raise KeyError(name)


@cache
def certificates(name: str, models: Path) -> sscc.Certificates:
    """Returns certificates of that model, which tests share."""
    return load(name, models).certify(scheme="paper", progress=False)


def configurations(model: sscc.Model, count: int, most: float) -> F64:
    """Returns random q: z_i = N(0, 1) / i, scaled to a largest vertex displacement of 0.5% to 100% of ``most`` half diagonals
    of the AABB."""
    random = np.random.default_rng(2026)
    vertices = model.vertices[np.unique(model.faces)]
    half = np.linalg.norm(np.ptp(vertices, axis=0)) / 2
    modes = model.modes[np.unique(model.faces)]
    scales = np.linalg.norm(modes, axis=1).max(axis=0)
    scales[scales == 0] = 1
    qs = random.normal(size=(count, model.rank)) / np.arange(1, model.rank + 1) / scales
    shares = most * 10 ** random.uniform(np.log10(0.005), 0, count)
    largest = np.array([np.linalg.norm(modes @ q, axis=1).max() for q in qs])
    scaled: F64 = qs * (shares * half / largest)[:, None]
    return scaled


def libigl_pairs(positions: F64, faces: I64) -> U32:
    """Returns the pairs of triangles without a common vertex that intersect, by CGAL's exact predicates: sorted, (n, 2)."""
    import igl.copyleft.cgal

    found = igl.copyleft.cgal.remesh_self_intersections(positions, faces, detect_only=True)[2]
    pairs = np.unique(np.sort(np.asarray(found, np.int64).reshape(-1, 2), axis=1), axis=0)
    share = (faces[pairs[:, 0]][:, :, None] == faces[pairs[:, 1]][:, None, :]).any(axis=(1, 2))
    apart: U32 = pairs[~share].astype(np.uint32)
    return apart


def meets_at_coincident_vertices(positions: F64, faces: I64, pairs: U32) -> NDArray[np.bool_]:
    """Returns for each pair whether its triangles have different vertices at the same position, and no common vertex."""
    a, b = faces[pairs[:, 0]][:, :, None], faces[pairs[:, 1]][:, None, :]
    equal = (positions[a] == positions[b]).all(axis=3)
    found: NDArray[np.bool_] = equal.any(axis=(1, 2)) & (a != b).all(axis=(1, 2))
    return found


def without(pairs: U32, others: U32) -> U32:
    """Returns the pairs that are not among the others."""
    rows = {(i, j) for i, j in others.tolist()}
    return np.array([pair for pair in pairs.tolist() if tuple(pair) not in rows], np.uint32).reshape(-1, 2)


def unexplained(positions: F64, faces: I64, found: U32, libigl: U32) -> tuple[list[str], int]:
    """Returns all differences except contacts at coincident vertices, and the number of these contacts."""
    more = without(found, libigl)
    explained = meets_at_coincident_vertices(positions, faces, more)
    wrong = [f"only sscc lists {pair}" for pair in more[~explained].tolist()]
    wrong += [f"only libigl lists {pair}" for pair in without(libigl, found).tolist()]
    return wrong, int(explained.sum())


def _ask(question: tuple[F64, I64]) -> U32:
    return libigl_pairs(*question)


def libigl_answers(questions: Iterable[tuple[F64, I64]]) -> Iterator[U32]:
    """Computes the answers to all questions, on all cores."""
    with multiprocessing.get_context("spawn").Pool(os.cpu_count()) as pool:
        yield from pool.imap(_ask, questions)


def differences(name: str, models: Path, count: int = COMPARED) -> tuple[int, int, list[int]]:
    """Returns the number of colliding configurations, the number of pairs, and the configurations where libigl differs."""
    model = load(name, models)
    certs = certificates(name, models)
    qs = configurations(model, max(count, COUNT), MODELS[name])[:count]
    batch = certs.check_many(qs, progress=False)
    faces = model.faces.astype(np.int64)
    answers = libigl_answers((model.positions(q), faces) for q in qs)
    both = enumerate(zip(batch, answers, strict=True))
    wrong = [i for i, (answer, exact) in both if not np.array_equal(answer.pairs, exact)]
    return int(batch.colliding.sum()), len(batch.pairs), wrong
