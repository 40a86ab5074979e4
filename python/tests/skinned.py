"""Skinned characters of glTF files, evaluated in double precision: node transforms, one animation, one skin.

It reads files with linear keys and without morph targets, such as those of Fox and CesiumMan.
"""

from __future__ import annotations

import base64
import json
import struct
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

TYPES = {5121: np.uint8, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}


@dataclass(frozen=True)
class Character:
    """A mesh with a skin, and the animations of its bones."""

    gltf: dict[str, Any]
    data: bytes
    node: int

    @classmethod
    def load(cls, path: Path, place: int = 0) -> Character:
        """Reads a GLB or glTF file. ``place`` is the index of the node among those with a skin."""
        content = path.read_bytes()
        if content.startswith(b"glTF"):
            size = struct.unpack_from("<I", content, 12)[0]
            gltf, data = json.loads(content[20 : 20 + size]), content[20 + size + 8 :]
        else:
            gltf, data = json.loads(content), b""
            starts = []
            for buffer in gltf["buffers"]:
                starts.append(len(data))
                uri = buffer["uri"]
                is_data = uri.startswith("data:")
                data += base64.b64decode(uri.split(",")[1]) if is_data else (path.parent / uri).read_bytes()
            for view in gltf["bufferViews"]:
                view["byteOffset"] = view.get("byteOffset", 0) + starts[view["buffer"]]
        skinned = [i for i, node in enumerate(gltf["nodes"]) if "skin" in node]
        return cls(gltf, data, skinned[place])

    def array(self, accessor: int) -> NDArray[Any]:
        """Returns the rows of an accessor."""
        a = self.gltf["accessors"][accessor]
        view = self.gltf["bufferViews"][a["bufferView"]]
        dtype, width = np.dtype(TYPES[a["componentType"]]), WIDTHS[a["type"]]
        start = view.get("byteOffset", 0) + a.get("byteOffset", 0)
        stride = view.get("byteStride", dtype.itemsize * width)
        rows = [
            np.frombuffer(self.data, dtype, width, start + row * stride) for row in range(a["count"])
        ]
        return np.array(rows)

    @cached_property
    def mesh(self) -> tuple[F64, I64, F64]:
        """Returns vertices (V, 3), faces (F, 3) and weights of all bones (V, B) of all primitives."""
        skin = self.gltf["skins"][self.gltf["nodes"][self.node]["skin"]]
        vertices, faces, weights, count = [], [], [], 0
        for part in self.gltf["meshes"][self.gltf["nodes"][self.node]["mesh"]]["primitives"]:
            named = part["attributes"]
            points = self.array(named["POSITION"]).astype(float)
            corners = self.array(part["indices"])[:, 0] if "indices" in part else np.arange(len(points))
            of_bones = np.zeros((len(points), len(skin["joints"])))
            joints, shares = self.array(named["JOINTS_0"]), self.array(named["WEIGHTS_0"]).astype(float)
            np.add.at(of_bones, (np.arange(len(points))[:, None], joints), shares)
            vertices.append(points)
            faces.append(corners.astype(np.int64).reshape(-1, 3) + count)
            weights.append(of_bones)
            count += len(points)
        return np.concatenate(vertices), np.concatenate(faces), np.concatenate(weights)

    @cached_property
    def classes(self) -> I64:
        """Returns a class for each vertex: vertices of equal position and weights are in one class."""
        vertices, _, weights = self.mesh
        rows = np.concatenate([vertices, weights], axis=1) + 0.0
        found: I64 = np.unique(rows, axis=0, return_inverse=True)[1].reshape(-1)
        return found

    def duration(self, animation: int) -> float:
        """Returns the time of the last key (s)."""
        samplers = self.gltf["animations"][animation]["samplers"]
        return max(float(self.array(sampler["input"]).max()) for sampler in samplers)

    def bones(self, animation: int, time: float) -> F64:
        """Returns the matrices of the bones, (B, 4, 4): they map vertices at rest to the world at that time."""
        parts = [dict(node) for node in self.gltf["nodes"]]
        moves = self.gltf["animations"][animation]
        for channel in moves["channels"]:
            sampler = moves["samplers"][channel["sampler"]]
            assert sampler.get("interpolation", "LINEAR") == "LINEAR"
            times, values = self.array(sampler["input"])[:, 0], self.array(sampler["output"]).astype(float)
            path, part = channel["target"]["path"], parts[channel["target"]["node"]]
            part[path] = interpolated(times.astype(float), values, time, path == "rotation")
        parents = {child: i for i, part in enumerate(parts) for child in part.get("children", [])}

        def world(i: int) -> F64:
            here = local(parts[i])
            return world(parents[i]) @ here if i in parents else here

        skin = self.gltf["skins"][self.gltf["nodes"][self.node]["skin"]]
        inverse = self.array(skin["inverseBindMatrices"]).astype(float).reshape(-1, 4, 4).transpose(0, 2, 1)
        found: F64 = np.stack([world(joint) for joint in skin["joints"]]) @ inverse
        return found

    def positions(self, bones: F64) -> F64:
        """Returns the skinned vertices (V, 3), computed bone by bone."""
        vertices, _, weights = self.mesh
        posed = np.zeros_like(vertices)
        for bone, share in zip(bones, weights.T, strict=True):
            posed += share[:, None] * (vertices @ bone[:3, :3].T + bone[:3, 3])
        return posed


def interpolated(times: F64, values: F64, time: float, is_rotation: bool) -> F64:
    """Returns the value of a track at a time: linear interpolation, for rotations along the shorter arc."""
    found: F64
    after = int(np.clip(np.searchsorted(times, time, side="right"), 1, max(len(times) - 1, 1)))
    if len(times) == 1 or time <= times[0]:
        found = values[0]
    elif time >= times[-1]:
        found = values[-1]
    else:
        share = (time - times[after - 1]) / (times[after] - times[after - 1])
        a, b = values[after - 1], values[after]
        if not is_rotation:
            found = a * (1 - share) + b * share
            return found
        a, b = a / np.linalg.norm(a), b / np.linalg.norm(b)
        b = b if a @ b >= 0 else -b
        angle = np.arctan2(np.linalg.norm(a - b), np.linalg.norm(a + b)) * 2
        if angle < 1e-9:
            found = a
            return found
        found = (np.sin((1 - share) * angle) * a + np.sin(share * angle) * b) / np.sin(angle)
    return found / np.linalg.norm(found) if is_rotation else found


def local(node: dict[str, Any]) -> F64:
    """Returns the matrix of a node."""
    if "matrix" in node and not {"translation", "rotation", "scale"} & node.keys():
        return np.array(node["matrix"], float).reshape(4, 4).T
    x, y, z, w = np.array(node.get("rotation", [0, 0, 0, 1]), float) / np.linalg.norm(
        node.get("rotation", [0, 0, 0, 1])
    )
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    matrix = np.eye(4)
    matrix[:3, :3] = turn * np.array(node.get("scale", [1, 1, 1]), float)
    matrix[:3, 3] = node.get("translation", [0, 0, 0])
    return matrix
