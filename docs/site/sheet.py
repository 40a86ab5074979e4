"""Writes the mesh and the frames of the report in how-it-works.md: a sheet that rolls up until it passes through itself."""

from __future__ import annotations

import math
from pathlib import Path

ALONG, ACROSS, FRAMES = 40, 16, 25


def positions(turns: float) -> list[str]:
    """The vertices of a sheet that is rolled up by so many turns, as lines of an OBJ file."""
    bend, lines = 2 * math.pi * turns, []
    for i in range(ALONG + 1):
        s = i / ALONG
        x, z = (math.sin(bend * s) / bend, (1 - math.cos(bend * s)) / bend) if bend else (s, 0.0)
        lines += [f"v {4 * x:.6f} {2 * j / ACROSS:.6f} {4 * z:.6f}\n" for j in range(ACROSS + 1)]
    return lines


def write(folder: Path) -> None:
    """Writes `sheet.obj` and `frames/`."""
    faces = []
    for i in range(ALONG):
        for j in range(ACROSS):
            a = i * (ACROSS + 1) + j + 1
            b, c = a + 1, a + ACROSS + 1
            faces += [f"f {a} {c} {b}\n", f"f {b} {c} {c + 1}\n"]
    (folder / "sheet.obj").write_text("".join(positions(0) + faces))
    (folder / "frames").mkdir()
    for frame in range(FRAMES):
        (folder / f"frames/{frame}.obj").write_text("".join(positions(1.3 * frame / (FRAMES - 1))))
