"""Meshes of USD files at each time sample: ``from_usd``. Needs the package usd-core."""

from __future__ import annotations

import re
from os import PathLike, fspath
from typing import Any, NamedTuple
from warnings import warn

import numpy as np
from numpy.typing import NDArray

from sscc._files import check_regular, escaped
from sscc._sscc import _triangulated
from sscc._text import counted, quoted

__all__ = ["UsdMesh", "from_usd"]


class UsdMesh(NamedTuple):
    """A mesh of a USD file, as its stage shows it."""

    name: str
    """The path of its prim."""
    faces: NDArray[np.uint32]
    """Triangles (F, 3). Polygons are triangulated as in OBJ files."""
    frames: NDArray[np.float64]
    """Positions in the coordinates of the stage, (T, V, 3)."""
    times: NDArray[np.float64]
    """The time of each frame (s); only 0 for a mesh without time samples."""

    def __repr__(self) -> str:
        sizes = f"{counted(len(self.faces), 'triangle')}, {counted(len(self.times), 'frame')}"
        return f"<sscc.UsdMesh: {quoted(self.name)}, {sizes}>"


def from_usd(path: str | PathLike[str], prim: str | None = None) -> UsdMesh:
    """Returns the mesh of a USD file (``.usd``, ``.usda``, ``.usdc``, ``.usdz``) at every time at which its points or
    its transforms have a sample.

    prim: the path of a prim of type Mesh. None means the only one.

    Skins and instances are evaluated. Instances of a PointInstancer are not: a warning names it. A subdivision surface
    is replaced by its control mesh. Alembic files can be read if the installed USD has the plugin for them.

    >>> mesh = sscc.from_usd("cloth.usda")
    >>> sscc.Detector(mesh.faces, mesh.frames[0]).check_many(mesh.frames).colliding

    ``numpy.save("frames.npy", mesh.frames)`` writes the file for ``sscc check --frames``. Raises ImportError without the package
    usd-core, OSError (such as FileNotFoundError) if the file cannot be opened, and ValueError for a
    malformed file, for a mesh that is missing or not unique, and for faces that change over time.
    """
    try:
        from pxr import Usd, UsdGeom, UsdSkel
    except ImportError as missing:
        raise ImportError("sscc.from_usd needs usd-core, which is not installed: pip install usd-core") from missing
    check_regular(path)
    with open(path, "rb"):
        pass
    place = escaped(path)
    try:
        stage = Usd.Stage.Open(fspath(path))
    except Exception as error:
        causes = re.findall(r": '(.*)'", str(error)) or ["it is malformed"]
        raise ValueError(f"{place}: USD cannot read it: {causes[-1]}") from error
    per_second = stage.GetTimeCodesPerSecond()
    # Skins are written into a layer of this session, not into the file. Times of layers with another rate are scaled.
    stage.GetSessionLayer().timeCodesPerSecond = per_second
    stage.SetEditTarget(stage.GetSessionLayer())
    _make_instances_plain(stage)
    UsdSkel.BakeSkinning(stage.Traverse())
    for found in stage.Traverse():
        if found.IsA(UsdGeom.PointInstancer):
            warn(f"{place}: {found.GetPath()}: a PointInstancer is not evaluated: its instances are left out", stacklevel=2)
    meshes = {str(found.GetPath()): UsdGeom.Mesh(found) for found in stage.Traverse() if found.IsA(UsdGeom.Mesh)}
    if not meshes:
        raise ValueError(f"{place}: the file has no prim of type Mesh")
    if prim is None and len(meshes) > 1:
        raise ValueError(f"{place}: the file has {len(meshes)} meshes: choose one by prim: {_listed(meshes)}")
    name = next(iter(meshes)) if prim is None else str(prim)
    if name not in meshes:
        raise ValueError(f"{place}: no mesh has the path {quoted(name)}; the paths are {_listed(meshes)}")
    prim_of_mesh = meshes[name].GetPrim()
    is_skinned = UsdSkel.BindingAPI(prim_of_mesh).GetJointIndicesAttr().HasAuthoredValue()
    if is_skinned and not _has_values(stage.GetSessionLayer(), f"{name}.points"):
        raise ValueError(f"{place}: {name}: USD cannot evaluate its skin")
    return _mesh(f"{place}: {name}", name, meshes[name], per_second)


def _has_values(layer: Any, path: str) -> bool:
    attribute = layer.GetAttributeAtPath(path)
    return attribute is not None and (attribute.default is not None or len(layer.ListTimeSamplesForPath(path)) > 0)


def _make_instances_plain(stage: Any) -> None:
    """Makes the prims of instances editable, in the layer of the session."""
    while instances := [prim for prim in stage.Traverse() if prim.IsInstance()]:
        for prim in instances:
            prim.SetInstanceable(False)


def _mesh(place: str, name: str, mesh: Any, per_second: float) -> UsdMesh:
    from pxr import Usd, UsdGeom

    counts, corners = mesh.GetFaceVertexCountsAttr(), mesh.GetFaceVertexIndicesAttr()
    if counts.GetNumTimeSamples() > 1 or corners.GetNumTimeSamples() > 1:
        raise ValueError(f"{place}: the faces change over time: a mesh with the same faces at all times was expected")
    points = mesh.GetPointsAttr()
    samples = set(points.GetTimeSamples())
    ancestor = mesh.GetPrim()
    while ancestor and not ancestor.IsPseudoRoot():
        samples |= set(UsdGeom.Xformable(ancestor).GetTimeSamples()) if ancestor.IsA(UsdGeom.Xformable) else set()
        ancestor = ancestor.GetParent()
    times = sorted(samples) or [0.0]
    frames: list[NDArray[np.float64]] = []
    for time in times:
        code = Usd.TimeCode(time)
        values = points.Get(code)
        if values is None:
            raise ValueError(f"{place}: the mesh has no points at time code {time:g}")
        x = np.asarray(values, dtype=np.float64).reshape(-1, 3)
        if frames and len(x) != len(frames[0]):
            raise ValueError(f"{place}: the mesh has {len(frames[0])} points at first, {len(x)} at time code {time:g}")
        matrix = np.asarray(mesh.ComputeLocalToWorldTransform(code), dtype=np.float64)
        frames.append(x @ matrix[:3, :3] + matrix[3, :3])
    first = Usd.TimeCode(times[0])
    faces = _triangles(place, counts.Get(first), corners.Get(first), frames[0])
    return UsdMesh(name, faces, np.array(frames), np.array(times) / per_second)


def _triangles(place: str, counts: Any, corners: Any, rest: NDArray[np.float64]) -> NDArray[np.uint32]:
    """Returns the triangles of polygons, as all readers of the package triangulate them."""
    counts, corners = (np.asarray(() if found is None else found, dtype=np.int64) for found in (counts, corners))
    faces, warnings = _triangulated(place, counts, corners, rest)
    for text in warnings:
        warn(text, stacklevel=4)
    return faces


def _listed(meshes: dict[str, Any]) -> str:
    names = [quoted(name) for name in list(meshes)[:10]]
    return ", ".join(names) + (", ..." if len(meshes) > 10 else "")
