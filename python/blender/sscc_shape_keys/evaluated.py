"""Exact self-collisions of the evaluated mesh of an object: after shape keys, armatures and all modifiers.

An answer belongs to the fingerprint of the evaluated mesh. Each status reads the mesh again and compares fingerprints.
So an answer is never shown for another shape.
"""

from __future__ import annotations

import hashlib
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

import bpy
import numpy as np
import sscc

from .shape import Unsupported
from .status import Status, colliding

T = TypeVar("T")

#: Detectors and answers of at most this many meshes are kept.
MAX_KEPT = 8


@dataclass(frozen=True)
class EvaluatedMesh:
    """The triangles of an evaluated mesh, in the object's coordinates."""

    positions: np.ndarray  #: (V, 3) float32
    faces: np.ndarray  #: (F, 3) vertex numbers of the triangles
    polygons: np.ndarray  #: (F) polygon of each triangle
    is_original: bool  #: whether its polygons are those of the stored mesh

    def topology(self) -> bytes:
        """Returns a hash of the faces and the number of vertices."""
        digest = hashlib.blake2b(str(len(self.positions)).encode(), digest_size=32)
        digest.update(np.ascontiguousarray(self.faces))
        return digest.digest()

    def fingerprint(self) -> bytes:
        """Returns a hash of the shape. Different shapes have different hashes."""
        digest = hashlib.blake2b(self.topology(), digest_size=32)
        digest.update(np.ascontiguousarray(self.positions))
        return digest.digest()


_detectors: OrderedDict[bytes, sscc.Detector] = OrderedDict()
_answers: OrderedDict[bytes, Status] = OrderedDict()
#: The fingerprint that was checked last, by the object's session number.
_last: dict[int, bytes] = {}


def forget() -> None:
    """Removes all answers and detectors."""
    _detectors.clear()
    _answers.clear()
    _last.clear()


def read(obj: bpy.types.Object | None, depsgraph: bpy.types.Depsgraph) -> EvaluatedMesh:
    """Returns the mesh that Blender draws. Raises `Unsupported` without an object, in Edit Mode and without faces."""
    if obj is None:
        raise Unsupported("select an object with a mesh")
    if obj.mode == "EDIT":
        raise Unsupported("leave Edit Mode: the mesh is being edited")
    evaluated = obj.evaluated_get(depsgraph)
    try:
        mesh = evaluated.to_mesh()
    except RuntimeError:
        mesh = None
    if mesh is None:
        raise Unsupported(f"{obj.name} ({obj.type.lower()}) has no mesh: select an object with faces")
    try:
        mesh.calc_loop_triangles()
        count = len(mesh.loop_triangles)
        if count == 0:
            raise Unsupported("the mesh has no faces")
        positions = np.empty(3 * len(mesh.vertices), np.float32)
        mesh.vertices.foreach_get("co", positions)
        corners, polygons = np.empty(3 * count, np.int32), np.empty(count, np.int32)
        mesh.loop_triangles.foreach_get("vertices", corners)
        mesh.loop_triangles.foreach_get("polygon_index", polygons)
        is_original = obj.type == "MESH" and has_same_polygons(obj.data, mesh)
    finally:
        evaluated.to_mesh_clear()
    return EvaluatedMesh(positions.reshape(-1, 3), corners.reshape(-1, 3), polygons, is_original)


def has_same_polygons(a: bpy.types.Mesh, b: bpy.types.Mesh) -> bool:
    """Whether two meshes have the same polygons with the same vertices."""
    if (len(a.vertices), len(a.polygons), len(a.loops)) != (len(b.vertices), len(b.polygons), len(b.loops)):
        return False

    def numbers(mesh: bpy.types.Mesh) -> tuple[np.ndarray, np.ndarray]:
        loops, starts = np.empty(len(mesh.loops), np.int32), np.empty(len(mesh.polygons), np.int32)
        mesh.loops.foreach_get("vertex_index", loops)
        mesh.polygons.foreach_get("loop_start", starts)
        return loops, starts

    return all(np.array_equal(x, y) for x, y in zip(numbers(a), numbers(b), strict=True))


def check(obj: bpy.types.Object | None, depsgraph: bpy.types.Depsgraph) -> Status:
    """Answers for the mesh that Blender draws now. Raises `Unsupported`, and ValueError if a position is not finite."""
    mesh = read(obj, depsgraph)
    detector = _kept(_detectors, mesh.topology(), lambda: sscc.Detector(mesh.faces))
    pairs = detector.check(mesh.positions).pairs
    if len(pairs) == 0:
        answer = Status("free", "evaluated mesh: free")
    else:
        found = colliding(pairs, mesh.polygons, mesh.positions, mesh.faces)
        text = f"evaluated mesh: {found.text}"
        if mesh.is_original:
            answer = Status(found.kind, text, found.polygons, found.corners)
        else:  # its polygons cannot be selected
            answer = Status(found.kind, f"{text}; modifiers change the faces", corners=found.corners)
    fingerprint = mesh.fingerprint()
    _answers.pop(fingerprint, None)
    _kept(_answers, fingerprint, lambda: answer)
    _last[obj.session_uid] = fingerprint
    return answer


def status(obj: bpy.types.Object | None, depsgraph: bpy.types.Depsgraph) -> Status | None:
    """Returns the answer for the mesh that Blender draws now; None if there is no object, or it was not checked."""
    if obj is None or obj.session_uid not in _last:
        return None
    try:
        mesh = read(obj, depsgraph)
    except Unsupported as reason:
        return Status("unsupported", str(reason))
    answer = _answers.get(mesh.fingerprint())
    if answer is None:
        return Status("changed", "evaluated mesh: changed, check again")
    return answer


def _kept(store: OrderedDict[bytes, T], name: bytes, make: Callable[[], T]) -> T:
    """Returns the entry of that name, made if there is none. Removes the entries that were used least recently."""
    if name not in store:
        store[name] = make()
    store.move_to_end(name)
    while len(store) > MAX_KEPT:
        store.popitem(last=False)
    return store[name]
