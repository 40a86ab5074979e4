"""Models with computed modes, from bodies and from samples of a shape.

A ``source`` is a file or a surface as ``(vertices, faces)``: (V, 3) numbers and (F, 3) integers. Files are
triangle meshes (OBJ, PLY, OFF, STL) or solids of tetrahedra and cubes (Medit ``.mesh``, VegaFEM ``.veg``, gmsh
``.msh``, TetGen ``.node``, ``.ele``). A surface must be closed; its solid is a lattice of cubes around it.

Common arguments:

- ``fix``: numbers of fixed vertices (n,); ``fix_box``: two corners (2, 3) of a box in which all vertices are fixed.
  Without fixed vertices the body is free, and its rigid motions are not among the modes.
- ``youngs``, ``poisson``, ``density``: the material; None: that of a solid's file, else 1e6, 0.4 and 1000.
- ``resolution``: number of cubes along the longest side of the lattice; None: about 20,000 cubes in all.
- ``threads``, ``progress``: as in ``Model.certify``.

All raise ValueError, TypeError, FileNotFoundError or OSError with a message that names the argument or the file.
"""

from __future__ import annotations

from os import PathLike
from typing import Literal

from numpy.typing import ArrayLike

from sscc._progress import Report
from sscc._sscc import Model, _elastic, _pca, _polynomial

__all__ = ["linear", "nonlinear", "pca", "polynomial"]

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
    """The ``rank`` (None: 20) lowest natural vibrations of a body. The metric is their strain energy."""
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
    """A basis of ``rank`` (None: 30) modes for large deformations (modal derivatives), with its reduced forces."""
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
    """The 24 quadratic polynomials of the rest position without rigid motions.

    Modes of a surface need no volume, and its metric is displacement. With ``solid=True``, a ``resolution`` or a
    material, and for solids in files, the model has the stiffness and the forces of the body, and the metric is its
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
    """The mean of shapes and their principal components. q is in standard deviations.

    shapes: (n, V, 3) or (n, 3V), with their ``faces`` (F, 3); or a folder of meshes with the same faces.
    rank: number of components, less than the number of shapes; None: as many as explain 99.9% of the variance.
    """
    return _pca(shapes, faces, rank, threads, progress)
