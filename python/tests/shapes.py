"""Models created in code."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]


def torus(around: int, across: int, rank: int) -> tuple[F64, I64, F64]:
    """Returns a torus of 2 around x across triangles with smooth random modes: vertices, faces, modes (V, 3, r)."""
    u, v = np.meshgrid(np.arange(around) / around, np.arange(across) / across, indexing="ij")
    u, v = 2 * np.pi * u.ravel(), 2 * np.pi * v.ravel()
    radius = 1 + 0.3 * np.cos(v)
    vertices = np.stack([radius * np.cos(u), radius * np.sin(u), 0.3 * np.sin(v)], axis=1)
    i, j = np.divmod(np.arange(around * across), across)
    a, b = i * across + j, (i + 1) % around * across + j
    c, d = (i + 1) % around * across + (j + 1) % across, i * across + (j + 1) % across
    faces = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    random = np.random.default_rng(1)
    waves = random.normal(size=(rank, 3, 3, 2))
    phase = np.stack([np.stack([np.cos(k * u), np.sin(k * u)], axis=-1) for k in (1, 2, 3)])
    modes = np.einsum("rakt,kvt->var", waves, phase) * 0.3
    return vertices, faces, np.ascontiguousarray(modes)


def two_triangles() -> tuple[F64, I64, F64]:
    """Returns two triangles at distance 1, and one mode that moves the second one away: they touch at q = -1."""
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1]], float)
    modes = np.zeros((6, 3, 1))
    modes[3:, 2, 0] = 1
    return vertices, np.array([[0, 1, 2], [3, 4, 5]]), modes


def samples(count: int, rank: int, scale: float, seed: int = 7) -> F64:
    """Returns random q, (count, rank)."""
    return np.random.default_rng(seed).normal(size=(count, rank)) * scale


def write_obj(path: Path, vertices: F64, faces: I64) -> None:
    """Writes a mesh as OBJ with all digits."""
    rows = [f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()]
    rows += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces.tolist()]
    path.write_text("\n".join(rows))
