"""A small glTF file: a body, and a shirt that moves through it."""

from __future__ import annotations

import base64
import json
from pathlib import Path
from typing import Any

import numpy as np


def character(folder: Path) -> Path:
    """Writes a triangle ("body"), a triangle above it ("shirt") that the animation "wave" moves down by 2 in a second, and a
    node without a mesh."""
    body = [[0, 0, 0], [4, 0, 0], [0, 4, 0]]
    shirt = [[1, 1, 1], [1.5, 1, 1], [1, 1, 1.5]]
    arrays = [(body, "VEC3"), (shirt, "VEC3"), ([0, 1], "SCALAR"), ([[0, 0, 0], [0, 0, -2]], "VEC3")]
    file: dict[str, Any] = {
        "asset": {"version": "2.0"},
        "buffers": [],
        "bufferViews": [],
        "accessors": [],
        "meshes": [
            {"name": name, "primitives": [{"attributes": {"POSITION": number}, "material": number}]}
            for number, name in enumerate(("torso", "cotton"))
        ],
        "materials": [{"name": "skin"}, {"name": "cloth"}],
        "nodes": [{"name": "body", "mesh": 0}, {"name": "light"}, {"name": "shirt", "mesh": 1}],
        "animations": [
            {
                "name": "wave",
                "channels": [{"sampler": 0, "target": {"node": 2, "path": "translation"}}],
                "samplers": [{"input": 2, "output": 3}],
            }
        ],
    }
    for number, (values, kind) in enumerate(arrays):
        data = np.asarray(values, dtype="<f4")
        uri = "data:;base64," + base64.b64encode(data.tobytes()).decode()
        file["buffers"].append({"byteLength": data.nbytes, "uri": uri})
        file["bufferViews"].append({"buffer": number, "byteLength": data.nbytes})
        accessor = {"bufferView": number, "componentType": 5126, "count": len(data), "type": kind}
        if kind == "SCALAR":
            accessor |= {"min": [0], "max": [1]}
        file["accessors"].append(accessor)
    path = folder / "character.gltf"
    path.write_text(json.dumps(file))
    return path
