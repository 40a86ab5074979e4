"""Models with computed modes, from bodies and from samples of a shape.

A ``source`` is a file or a surface as ``(vertices, faces)``: (V, 3) numbers and (F, 3) integers. Files are
triangle meshes (OBJ, PLY, OFF, STL) or solids of tetrahedra and cubes (Medit ``.mesh``, VegaFEM ``.veg``, gmsh
``.msh``, TetGen ``.node``, ``.ele``, VTK ``.vtu``, ``.vtk``). A surface must be closed and must not meet itself, except for
polynomial modes without a solid; its solid is a lattice of cubes around it.

Common arguments:

- ``fix``: numbers of fixed vertices (n,); ``fix_box``: two finite corners (2, 3) of a box in which all vertices are fixed.
  Without fixed vertices the body is free, and its rigid motions are not among the modes.
- ``youngs`` (N/m^2), ``poisson``, ``density`` (kg/m^3): the material, for a source in metres. None means the material of a solid's
  file, else 1e6, 0.4 and 1000.
- ``resolution``: number of cubes along the longest side of the lattice. None means about 20,000 cubes in total.
- ``threads``, ``progress``: as in ``Model.certify``.

``skinning`` returns modes, not a model: the modes of linear blend skinning.

All functions raise ValueError, TypeError, FileNotFoundError or OSError with a message that names the argument or the file.
"""

from __future__ import annotations

from os import PathLike
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sscc._affine import affine_modes
from sscc._arrays import check_finite
from sscc._progress import Report
from sscc._sscc import Model, _elastic, _numbers, _pca, _polynomial

__all__ = ["linear", "nonlinear", "pca", "polynomial", "skinning", "skinning_q"]

#: Maximum difference from 1 of a vertex's sum of weights: files store weights in as few as 8 bits.
MAX_WEIGHT_ERROR = 0.01

Source = str | PathLike[str] | tuple[ArrayLike, ArrayLike]


def linear(
    source: Source,
    rank: int | None = None,
    *,
    fix: ArrayLike | None = None,
    fix_box: ArrayLike | None = None,
    youngs: float | None = None,
    poisson: float | None = None,
    density: float | None = None,
    resolution: int | None = None,
    threads: int | None = None,
    progress: Report | bool | None = None,
) -> Model:
    """Returns a model with the ``rank`` (None: 20) lowest natural vibrations of a body. The metric is their strain energy."""
    material = (youngs, poisson, density)
    return _elastic(source, "linear", rank, fix, fix_box, material, resolution, threads, progress)


def nonlinear(
    source: Source,
    rank: int | None = None,
    *,
    fix: ArrayLike | None = None,
    fix_box: ArrayLike | None = None,
    youngs: float | None = None,
    poisson: float | None = None,
    density: float | None = None,
    resolution: int | None = None,
    threads: int | None = None,
    progress: Report | bool | None = None,
) -> Model:
    """Returns a model with ``rank`` (None: 30) modes for large deformations (modal derivatives), and its reduced forces."""
    material = (youngs, poisson, density)
    return _elastic(source, "nonlinear", rank, fix, fix_box, material, resolution, threads, progress)


def polynomial(
    source: Source,
    *,
    solid: bool = False,
    youngs: float | None = None,
    poisson: float | None = None,
    density: float | None = None,
    resolution: int | None = None,
    threads: int | None = None,
    progress: Report | bool | None = None,
) -> Model:
    """Returns a model with the 24 quadratic polynomials of the rest position without rigid motions; special shapes, such as a
    sphere, have fewer.

    For a surface the modes need no volume, and the metric is the displacement metric. With ``solid=True``, a ``resolution`` or a
    material, and for solids in files, the model has the stiffness and the forces of the body, and the metric is the body's
    strain energy.
    """
    material = (youngs, poisson, density)
    options = (*material, resolution)
    kind: Literal["polynomial"] = "polynomial"
    if solid or any(option is not None for option in options):
        return _elastic(source, kind, None, None, None, material, resolution, threads, progress)
    return _polynomial(source, threads, progress)


def pca(
    shapes: str | PathLike[str] | ArrayLike,
    faces: ArrayLike | None = None,
    rank: int | None = None,
    *,
    threads: int | None = None,
    progress: Report | bool | None = None,
) -> Model:
    """Returns a model with the mean and the principal components of shapes. q is in standard deviations.

    shapes: (n, V, 3) or (n, 3V), with their ``faces`` (F, 3); or a folder of meshes with the same faces. There are at most
    4,096 shapes, unless their faces have at most 1,365 vertices.
    rank: number of components, less than the number of shapes. None means as many as explain 99.9% of the variance.
    """
    return _pca(shapes, faces, rank, threads, progress)


def skinning(vertices: ArrayLike, weights: ArrayLike) -> NDArray[np.float64]:
    """Returns the modes U (V, 3, 12 B) of linear blend skinning by B bones: ``vertices + U q`` is the skinned mesh.

    vertices: (V, 3), in the pose in which the mesh was bound to its bones (for body models: with all corrections).
    weights: (V, B), not negative. Each row must sum to 1 (within 0.01) and is divided by its sum.

    q has 12 entries for each bone: the first three rows of its matrix minus the identity, row by row. So q[12 b + 4 i +
    j] is entry (i, j) of the matrix of bone b, minus 1 if i = j; j = 3 is the translation. ``skinning_q`` computes
    it. A matrix maps the vertex from the bind pose to its position: in glTF it is ``joint_world @ inverse_bind``.

    Answers are exact for every q. But a usual motion of one bone is a large q, so certificates prove only small motions
    about their centre free (docs/python.md has measurements). For poses of an animation, ``Detector`` is faster.
    """
    x = _numbers(vertices, "vertices")
    w = _numbers(weights, "weights")
    if x.ndim != 2 or x.shape[1] != 3:
        raise ValueError(f"vertices has shape {list(x.shape)}: (V, 3) was expected")
    if w.ndim != 2 or w.shape[0] != len(x) or w.shape[1] == 0:
        raise ValueError(f"weights has shape {list(w.shape)}: ({len(x)}, B) was expected, a row for each vertex")
    for wrong, what in ((~np.isfinite(w), "finite"), (w < 0, "at least 0")):
        if wrong.any():
            vertex, bone = np.argwhere(wrong)[0]
            raise ValueError(f"weights[{vertex}, {bone}] is {w[vertex, bone]}: every weight must be {what}")
    sums = w.sum(axis=1, keepdims=True)
    far = np.abs(sums[:, 0] - 1) > MAX_WEIGHT_ERROR
    if far.any():
        vertex = int(np.argmax(far))
        raise ValueError(
            f"weights[{vertex}] sums to {sums[vertex, 0]:.6g}: 1 was expected; "
            "to normalize, pass weights / weights.sum(axis=1, keepdims=True)"
        )
    return affine_modes(x, w / sums)


def skinning_q(matrices: ArrayLike) -> NDArray[np.float64]:
    """Returns q (12 B,) of the bone matrices (B, 3, 4) or (B, 4, 4), for the modes of ``skinning``.

    Leading axes are poses: (n, B, 4, 4) gives Q (n, 12 B). The last row of a 4 x 4 matrix must be (0, 0, 0, 1).
    """
    m = _numbers(matrices, "matrices")
    if m.ndim < 3 or m.shape[-2:] not in ((3, 4), (4, 4)):
        raise ValueError(f"matrices has shape {list(m.shape)}: (B, 3, 4) or (B, 4, 4) was expected")
    check_finite(m, "matrices")
    projective = (m[..., 3:, :] != (0, 0, 0, 1)).any(axis=(-2, -1))
    if projective.any():
        place = [int(i) for i in np.argwhere(projective)[0]]
        raise ValueError(
            f"matrices{place} has the last row {m[tuple(place)][3].tolist()}: [0, 0, 0, 1] was expected; "
            "matrices that multiply row vectors must be transposed"
        )
    rows: NDArray[np.float64] = m[..., :3, :] - np.eye(3, 4)
    return rows.reshape(*m.shape[:-3], 12 * m.shape[-3])
