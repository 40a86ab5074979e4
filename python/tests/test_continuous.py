"""Continuous queries equal exact arithmetic, and differences from another library (ipctk) are explained."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import sscc
from exact import MODELS, configurations, load
from first_contact import first_contact
from shapes import samples, torus

F64 = NDArray[np.float64]

#: The distance within which triangles may be listed without touching, as a share of their size.
TOLERANCE = 2.0**-40


def coarse(numbers: F64, bits: int = 5) -> F64:
    """Rounds numbers to few binary digits, with which exact arithmetic is fast."""
    return np.round(numbers * 2.0**bits) / 2.0**bits


def coarse_torus(around: int, across: int, rank: int) -> sscc.Model:
    """Returns a torus whose coordinates have few digits, so that some triangles touch exactly."""
    vertices, faces, modes = torus(around, across, rank)
    return sscc.Model(coarse(vertices), faces, coarse(modes))


def moving(model: sscc.Model, q0: F64, q1: F64) -> F64:
    """Returns the corners of every triangle at both ends, (F, 2, 3, 3)."""
    return np.stack([model.positions(q)[model.faces] for q in (q0, q1)], axis=1)


def contact(corners: F64, i: int, j: int) -> float | None:
    """Returns the exact time of impact of two triangles."""
    return first_contact(corners[[i, j]])


def candidates(corners: F64, faces: NDArray[np.uint32]) -> Iterator[tuple[int, int]]:
    """Returns pairs of triangles without a common vertex whose swept AABBs overlap."""
    low, high = corners.min(axis=(1, 2)), corners.max(axis=(1, 2))
    for i in range(len(faces)):
        near = ((low[i] <= high[i + 1 :]) & (low[i + 1 :] <= high[i])).all(axis=1)
        near &= ~np.isin(faces[i + 1 :], faces[i]).any(axis=1)
        yield from ((i, int(i + 1 + j)) for j in np.flatnonzero(near))


def is_close(corners: F64, i: int, j: int, time: float) -> bool:
    """Whether two triangles are within the tolerance at that time, up to the rounding of the positions themselves."""
    pair = corners[[i, j]]
    at = pair[:, 0] * (1 - time) + pair[:, 1] * time
    size = np.ptp(pair.reshape(-1, 3), axis=0).max()
    return bool(distance(at[0], at[1]) <= TOLERANCE * size + 8 * np.finfo(float).eps * np.abs(pair).max())


def distance(x: F64, y: F64) -> float:
    """Returns the distance of two triangles that do not intersect."""
    edges = [(x[a], x[a - 1] - x[a], y[b], y[b - 1] - y[b]) for a in range(3) for b in range(3)]
    found = [segments(*pair) for pair in edges]
    found += [point_triangle(p, y) for p in x] + [point_triangle(p, x) for p in y]
    return min(found)


def segments(p: F64, d: F64, r: F64, e: F64) -> float:
    """Returns the distance of two segments p + s d and r + t e."""
    w = p - r
    a, b, c, f, g = (float(x @ y) for x, y in ((d, d), (d, e), (e, e), (d, w), (e, w)))
    best = float("inf")
    det = a * c - b * b
    guesses = [0.0, 1.0] + ([(b * g - c * f) / det] if det > 0 else [])
    for s in guesses:
        for _ in range(2):
            s = min(max(s, 0.0), 1.0)
            t = min(max((g + s * b) / c, 0.0), 1.0)
            best = min(best, float(np.linalg.norm(w + s * d - t * e)))
            s = (t * b - f) / a
    return best


def point_triangle(p: F64, t: F64) -> float:
    """Returns the distance of a point to the interior of a triangle; infinite if its projection is outside."""
    u, v, w = t[1] - t[0], t[2] - t[0], p - t[0]
    gram = np.array([[u @ u, u @ v], [u @ v, v @ v]])
    if np.linalg.det(gram) <= 0:
        return float("inf")
    s, r = np.linalg.solve(gram, [u @ w, v @ w])
    return float(np.linalg.norm(w - s * u - r * v)) if s >= 0 and r >= 0 and s + r <= 1 else float("inf")


def test_no_exact_impact_is_missed() -> None:
    """Tests a sample of the pairs with overlapping swept AABBs, since exact arithmetic is slow."""
    model = coarse_torus(10, 6, 3)
    certs = model.certify()
    random = np.random.default_rng(3)
    met = missed = 0
    for q0, q1 in zip(coarse(samples(4, 3, 0.6, seed=1)), coarse(samples(4, 3, 0.6, seed=2)), strict=True):
        corners = moving(model, q0, q1)
        reported = certs.continuous(q0, q1)
        times = {(i, j): t for (i, j), t in zip(reported.pairs.tolist(), reported.times.tolist(), strict=True)}
        near = list(candidates(corners, model.faces))
        assert set(times) <= set(near)
        other = [pair for pair in near if pair not in times]
        for pairs, count in ((sorted(times), 10), (other, 10)):
            for i, j in random.permutation(np.array(pairs).reshape(-1, 2))[:count].tolist():
                exact = contact(corners, i, j)
                if exact is not None:
                    assert times[i, j] <= exact + 2.0**-48
                    met += 1
                elif (i, j) in times:
                    assert is_close(corners, i, j, times[i, j])
                else:
                    missed += 1
    assert met > 10 and missed > 10


def ipctk_pairs(model: sscc.Model, q0: F64, q1: F64) -> set[tuple[int, int]]:
    """Returns pairs without a common vertex for which ipctk finds an impact of a vertex and a face or of two edges."""
    import ipctk

    faces = model.faces.astype(np.int32)
    starts, ends = model.positions(q0), model.positions(q1)
    mesh = ipctk.CollisionMesh(starts, ipctk.edges(faces), faces)
    of_vertex: list[set[int]] = [set() for _ in starts]
    for face, corners in enumerate(faces):
        for v in corners:
            of_vertex[v].add(face)
    found = ipctk.Candidates()
    found.build(mesh, starts, ends)
    pairs = set()

    def hits(candidate: ipctk.CollisionStencil) -> bool:
        both = [candidate.dof(positions, mesh.edges, mesh.faces) for positions in (starts, ends)]
        return bool(candidate.ccd(*both)[0])

    for candidate in found.fv_candidates:
        if hits(candidate):
            pairs |= {(f, candidate.face_id) for f in of_vertex[candidate.vertex_id]}
    for candidate in found.ee_candidates:
        if hits(candidate):
            a, b = mesh.edges[candidate.edge0_id], mesh.edges[candidate.edge1_id]
            of_a, of_b = of_vertex[a[0]] & of_vertex[a[1]], of_vertex[b[0]] & of_vertex[b[1]]
            pairs |= {(f, g) for f in of_a for g in of_b}
    return {(min(f, g), max(f, g)) for f, g in pairs if not np.isin(faces[f], faces[g]).any()}


def onsets(model: sscc.Model, qs: F64) -> Iterator[tuple[F64, F64]]:
    """Returns motions around the first impact on the line from rest to each q."""
    certs = model.certify()
    for q in qs:
        first = certs.continuous(0 * q, q).time_of_impact
        if first is not None:
            yield coarse(0.9 * first * q, 10), coarse(1.2 * first * q, 10)


@pytest.mark.usefixtures("ipctk")
@pytest.mark.parametrize("name", ["torus", "vega_A"])
def test_differences_from_ipctk_are_explained(name: str, request: pytest.FixtureRequest) -> None:
    if name == "torus":
        model = coarse_torus(24, 12, 6)
        ways = list(zip(coarse(samples(3, 6, 0.3, seed=3)), coarse(samples(3, 6, 0.3, seed=4)), strict=True))[::2]
    else:
        models: Path = request.getfixturevalue("models")
        real = load("vega_A", models)
        model = sscc.Model(coarse(real.vertices, 16), real.faces, coarse(real.modes, 16))
        ways = list(onsets(model, configurations(real, 40, MODELS["vega_A"])))[:3]
    certs = model.certify()
    both = theirs_alone = ours_alone = 0
    for q0, q1 in ways:
        corners = moving(model, q0, q1)
        impacts = certs.continuous(q0, q1)
        times = {(i, j): t for (i, j), t in zip(impacts.pairs.tolist(), impacts.times.tolist(), strict=True)}
        theirs = ipctk_pairs(model, q0, q1)
        both += len(theirs & times.keys())
        for i, j in sorted(theirs - times.keys()):
            # ipctk has a tolerance of 1e-6, so its pairs need not meet.
            exact = contact(corners, i, j)
            print(f"{name}: only ipctk reports {i}, {j}: exactly {exact}")
            assert exact is None
            theirs_alone += 1
        for i, j in sorted(times.keys() - theirs):
            # An edge may pierce a face during the whole motion: the pair has no impact of vertices or edges.
            exact = contact(corners, i, j)
            print(f"{name}: only sscc reports {i}, {j}: exactly {exact}")
            assert exact is not None or is_close(corners, i, j, times[i, j])
            ours_alone += 1
    print(f"{name}: {both} pairs of both, {theirs_alone} only of ipctk, {ours_alone} only of sscc")
    assert both > 10
