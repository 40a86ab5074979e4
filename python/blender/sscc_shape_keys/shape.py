"""The shape of a mesh with shape keys: basis + sum over k of value_k (key_k - relative_key_k).

Blender evaluates relative keys in this way. The differences are those of the stored keys, independent of the values of
other keys. Blender adds in single precision; certificates are about the sum in double precision.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass

import bpy
import numpy as np


class Unsupported(Exception):
    """The current state of an object is not supported. The message states the cause or the remedy."""


@dataclass(frozen=True)
class Shape:
    """The data on which certificates depend."""

    basis: np.ndarray  #: (V, 3) float32
    keys: np.ndarray  #: (K, V, 3) float32, without the basis
    relative: np.ndarray  #: (K) int64: index of the relative key of each key, -1 for the basis
    loops: np.ndarray  #: vertices of all polygons' corners
    starts: np.ndarray  #: index in `loops` of the first corner of each polygon

    def fingerprint(self) -> bytes:
        """Returns a hash of all arrays. Different shapes have different hashes."""
        digest = hashlib.blake2b(digest_size=32)
        for array in (self.basis, self.keys, self.relative, self.loops, self.starts):
            digest.update(f"{array.dtype} {array.shape} ".encode())
            digest.update(np.ascontiguousarray(array))
        return digest.digest()

    def modes(self) -> np.ndarray:
        """Returns the displacements of each key, (V, 3, K) float64."""
        references = np.concatenate([self.keys, self.basis[None]]).astype(float)[self.relative]
        return np.moveaxis(self.keys.astype(float) - references, 0, -1)


def check(obj: bpy.types.Object | None) -> None:
    """Raises `Unsupported` if there are no shape keys, or the shape on the screen is not the shape of the keys."""
    if obj is None or obj.type != "MESH":
        raise Unsupported("select a mesh")
    mesh = obj.data
    if mesh.shape_keys is None or len(mesh.shape_keys.key_blocks) < 2:
        raise Unsupported("the mesh has no shape keys beside the basis")
    if not mesh.shape_keys.use_relative:
        raise Unsupported("absolute shape keys are not supported: make them relative")
    if obj.mode != "OBJECT" or mesh.is_editmode:
        raise Unsupported("go to Object Mode: the mesh is being edited")
    if obj.show_only_shape_key:
        raise Unsupported("only the active key is shown: switch Shape Key Lock off")
    masked = [key.name for key in mesh.shape_keys.key_blocks if key.vertex_group]
    if masked:
        raise Unsupported(f"key '{masked[0]}' is masked by a vertex group, which is not supported: apply the mask")
    shown = [modifier.name for modifier in obj.modifiers if modifier.show_viewport]
    if shown:
        raise Unsupported(f"modifier '{shown[0]}' changes the shape: switch it off in the viewport")


def read(obj: bpy.types.Object) -> Shape:
    """Returns the stored shape."""
    mesh = obj.data
    blocks = list(mesh.shape_keys.key_blocks)
    count = len(mesh.vertices)
    points = np.empty((len(blocks), count, 3), np.float32)
    for place, block in enumerate(blocks):
        if len(block.points) != count:
            raise Unsupported(f"key '{block.name}' has {len(block.points)} points, the mesh has {count} vertices")
        block.points.foreach_get("co", points[place].reshape(-1))
    basis = blocks.index(mesh.shape_keys.reference_key)
    keys = [place for place in range(len(blocks)) if place != basis]
    place_of = {basis: -1, **{place: k for k, place in enumerate(keys)}}
    relative = [place_of[blocks.index(blocks[place].relative_key)] for place in keys]
    loops = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", loops)
    starts = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("loop_start", starts)
    return Shape(points[basis], points[keys], np.array(relative, np.int64), loops, starts)


def values(obj: bpy.types.Object) -> np.ndarray:
    """Returns the value of each key; 0 for muted keys."""
    keys = obj.data.shape_keys
    blocks = [block for block in keys.key_blocks if block != keys.reference_key]
    return np.array([0.0 if block.mute else block.value for block in blocks])


def triangles(obj: bpy.types.Object, shape: Shape) -> tuple[np.ndarray, np.ndarray]:
    """Returns the triangles into which Blender cuts the polygons of the basis, and the polygon of each triangle."""
    mesh = obj.data.copy()
    try:
        mesh.vertices.foreach_set("co", shape.basis.reshape(-1))
        mesh.calc_loop_triangles()
        count = len(mesh.loop_triangles)
        corners, polygons = np.empty(3 * count, np.int32), np.empty(count, np.int32)
        mesh.loop_triangles.foreach_get("vertices", corners)
        mesh.loop_triangles.foreach_get("polygon_index", polygons)
    finally:
        bpy.data.meshes.remove(mesh)
    return corners.reshape(-1, 3), polygons
