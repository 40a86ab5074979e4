"""Real meshes, and random poses of them: bends and twists, and animated characters."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import sscc
from skinned import Character

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

#: Meshes by name: the file, and for glTF files the name of the mesh or the index of the skinned node.
FILES: dict[str, tuple[str, str | int | None]] = {
    "bunny_69451": ("bunny_69451_open.obj", None),
    "bunny_69664": ("bunny_69664_closed.ply", None),
    "dragon_77202": ("dragon_77202_closed.ply", None),
    "bunny_14964": ("bunny_14964_closed.obj", None),
    "bunny_6966": ("bunny_6966_closed.off", None),
    "doubleLoopWithCube": ("selfintersecting/doubleLoopWithCube.obj", None),
    "ict_face": ("ict_face/ict_face_neutral.obj", None),
    "vega_A": ("vega_A/A.obj", None),
    "AnimatedMorphSphere": ("morph/AnimatedMorphSphere.gltf", None),
    "MorphStressTest": ("morph/MorphStressTest.gltf", None),
    "RobotExpressive head": ("morph/RobotExpressive.glb", "Head"),
    "Fox": ("skinned/Fox.glb", 0),
    "CesiumMan": ("skinned/CesiumMan.glb", 0),
    "greenman": ("skinned/greenman.glb", 0),
    "RobotExpressive right hand": ("skinned/RobotExpressive.glb", 0),
    "RobotExpressive left hand": ("skinned/RobotExpressive.glb", 1),
    "SimpleSkin": ("skinned/SimpleSkin.gltf", 0),
    "03_skinned_cylinder": ("skinned/03_skinned_cylinder.gltf", 0),
    "Animation_Skin_10": ("skinned/Animation_Skin_10.gltf", 0),
    "made_Fox_mixed": ("skinned/made_Fox_mixed.glb", 0),
    "cloth 227": ("ccd_frames/cloth-funnel/227.ply", None),
    "cloth 228": ("ccd_frames/cloth-funnel/228.ply", None),
}


@dataclass(frozen=True)
class Mesh:
    """A mesh of the folder of real models."""

    models: Path
    name: str

    @cached_property
    def _source(self) -> sscc.Model | Character:
        file, part = FILES[self.name]
        path = self.models / file
        if isinstance(part, int):
            return Character.load(path, part)
        if path.suffix in (".glb", ".gltf"):
            return sscc.Model.load(path, mesh_name=part)
        return sscc.modes.polynomial(path)  # a reader of meshes

    @cached_property
    def vertices(self) -> F64:
        """(V, 3)."""
        source = self._source
        return source.vertices if isinstance(source, sscc.Model) else source.mesh[0]

    @cached_property
    def faces(self) -> I64:
        """(F, 3)."""
        source = self._source
        return source.faces.astype(np.int64) if isinstance(source, sscc.Model) else source.mesh[1]

    def pose(self, number: int) -> F64:
        """Returns a random pose (V, 3): a bend and a twist; for every second pose of a character, a time of an animation."""
        random = np.random.default_rng([2026, number])
        x, source = self.vertices, self._source
        if isinstance(source, Character):
            animation = int(random.integers(len(source.gltf["animations"])))
            x = source.positions(source.bones(animation, random.uniform(0, source.duration(animation))))
            if random.uniform() < 0.5:
                return x
        elif source.mode_names:  # morph targets
            x = source.positions(random.uniform(-0.5, 1.5, source.rank))
        return bent(twisted(x, random), random)


@cache
def mesh(models: Path, name: str) -> Mesh:
    """Returns the mesh of that name."""
    return Mesh(models, name)


def frame(x: F64, random: np.random.Generator) -> tuple[F64, F64]:
    """Returns positions in a random orthonormal frame with largest coordinate 1, and the frame."""
    axes = np.linalg.qr(random.normal(size=(3, 3)))[0]
    y = (x - x.mean(axis=0)) @ axes
    size = np.abs(y).max()
    return y / size, axes * size


def twisted(x: F64, random: np.random.Generator) -> F64:
    """Returns positions rotated about an axis, with an angle that grows along it by up to several full rotations."""
    y, axes = frame(x, random)
    angle = y[:, 2] * 10 ** random.uniform(-1, 1)
    cos, sin = np.cos(angle), np.sin(angle)
    turned = np.stack([cos * y[:, 0] - sin * y[:, 1], sin * y[:, 0] + cos * y[:, 1], y[:, 2]], axis=1)
    found: F64 = turned @ axes.T
    return found


def bent(x: F64, random: np.random.Generator) -> F64:
    """Returns positions bent along a circle of random radius. If it is small, the ends meet or the inner side is inverted."""
    y, axes = frame(x, random)
    radius = 10 ** random.uniform(-0.7, 0.7)
    along, out = y[:, 0] / radius, radius - y[:, 1]
    turned = np.stack([out * np.sin(along), radius - out * np.cos(along), y[:, 2]], axis=1)
    found: F64 = turned @ axes.T
    return found
