"""A generated model for the examples: a mouth that can close, bite, smile and purse its lips."""

from __future__ import annotations

import json
import struct
from pathlib import Path

import numpy as np

#: A sheet of skin around an opening, with vertices on rings: 2 x 64 x 6 triangles.
AROUND, RINGS = 64, 6

NAMES = ["close", "bite", "smile", "purse"]


def mouth() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Vertices (V, 3), faces (F, 3) and modes (V, 3, 4) of the mouth, open: in the middle its lips are 0.6 apart."""
    spoke, ring = np.meshgrid(np.arange(AROUND), np.arange(RINGS + 1))
    angle = 2 * np.pi * spoke.ravel() / AROUND
    sin, cos, zero = np.sin(angle), np.cos(angle), np.zeros(angle.size)
    out = ring.ravel() / RINGS  # from the lips to the cheeks
    vertices = np.stack([(1 + out) * cos, (0.3 + out) * sin, 0.5 * out * (1 - out)], axis=1)
    fields = [
        (zero, -0.4 * sin * np.abs(sin), zero),
        (zero, 0.9 * np.minimum(sin, 0) ** 2, zero),
        (0.2 * cos, 0.3 * cos**2, zero),
        (-0.3 * cos, zero, zero + 0.3),
    ]
    modes = np.stack([np.stack(field, axis=1) for field in fields], axis=2) * (1 - out)[:, None, None] ** 2
    faces = []
    for inner in range(0, RINGS * AROUND, AROUND):
        for at in range(AROUND):
            a, b = inner + at, inner + (at + 1) % AROUND
            faces += [(a, a + AROUND, b), (b, a + AROUND, b + AROUND)]
    return vertices, np.array(faces), modes


def mouth_glb(folder: Path) -> Path:
    """Writes the mouth as ``mouth.glb`` with four morph targets. Each triangle has three vertices of its own, as in
    files of modelling programs with sharp edges: ``Model.certify`` welds them."""
    vertices, faces, modes = mouth()
    blocks = [part[faces.ravel()].astype("<f4").tobytes() for part in (vertices, *np.moveaxis(modes, 2, 0))]
    size, count = len(blocks[0]), range(len(blocks))
    document = {
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": size * len(blocks)}],
        "bufferViews": [{"buffer": 0, "byteOffset": i * size, "byteLength": size} for i in count],
        "accessors": [{"bufferView": i, "componentType": 5126, "type": "VEC3", "count": size // 12} for i in count],
        "meshes": [
            {
                "name": "Mouth",
                "primitives": [{"attributes": {"POSITION": 0}, "targets": [{"POSITION": i} for i in count[1:]]}],
                "extras": {"targetNames": NAMES},
            }
        ],
    }
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    binary = b"".join(blocks)
    path = folder / "mouth.glb"
    path.write_bytes(
        struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(binary))
        + struct.pack("<I4s", len(text), b"JSON")
        + text
        + struct.pack("<I4s", len(binary), b"BIN\0")
        + binary
    )
    return path
