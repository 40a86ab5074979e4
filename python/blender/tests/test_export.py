"""The motion exported by the page and the animation of a simulation, imported into Blender."""

from __future__ import annotations

import json
import os
import subprocess
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

bpy: Any = pytest.importorskip("bpy", reason="Blender as a module (pip install bpy) is not installed")

COMMAND = os.environ.get("SSCC_COMMAND")
pytestmark = pytest.mark.skipif(not COMMAND, reason="SSCC_COMMAND names no sscc command")

SECONDS = [0.0, 0.25, 0.5, 1.0]
# Weights of morph targets are usually in [0, 1]; q has any sign and size.
Q = np.array([[0, 0, 0], [0.5, -2, 11], [-1, 0.25, -40], [0.125, 3, 7]], float)


def tube() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Positions, faces, and the displacements of three modes (3 V x 3) of an open tube along x, away from 0."""
    along, around = np.meshgrid(np.linspace(0, 2, 13), np.arange(8) * np.pi / 4, indexing="ij")
    x, angle = along.ravel(), around.ravel()
    positions = np.stack([x + 5, 0.2 * np.cos(angle), 0.2 * np.sin(angle) - 1], axis=1)
    corners = [(8 * i + j, 8 * i + (j + 1) % 8) for i in range(12) for j in range(8)]
    faces = [f for a, b in corners for f in ((a, b, a + 8), (b, b + 8, a + 8))]
    zero = 0 * x
    moves = [(zero, 0.3 * x * x, zero), (zero, 0.1 * np.sin(3 * x), 0.1 * x), (0.01 * x, zero, 0.02 * x * x)]
    modes = np.stack([np.stack(move, axis=1).ravel() for move in moves], axis=1)
    return positions, np.array(faces), modes


@pytest.fixture
def address(tmp_path: Path) -> Iterator[str]:
    positions, faces, modes = tube()
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in positions.tolist()]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces.tolist()]
    (tmp_path / "tube.obj").write_text("\n".join(lines) + "\n")
    np.save(tmp_path / "modes.npy", modes)
    command = [str(COMMAND), "view", str(tmp_path / "tube.obj"), "--modes", str(tmp_path / "modes.npy"), "--no-open"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
        assert server.stdout is not None
        yield server.stdout.readline().strip()
        server.terminate()


def test_blender_shows_every_vertex_at_its_position(address: str, tmp_path: Path) -> None:
    page, token = address.split("/?token=")
    body = json.dumps({"q": Q.tolist(), "times": SECONDS}).encode()
    request = urllib.request.Request(f"{page}/api/glb", body, {"X-Sscc-Token": token})
    with urllib.request.urlopen(request) as answer:
        (tmp_path / "motion.glb").write_bytes(answer.read())

    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.fps = 24
    assert bpy.ops.import_scene.gltf(filepath=str(tmp_path / "motion.glb")) == {"FINISHED"}
    [shape] = [thing for thing in scene.objects if thing.type == "MESH"]

    positions, faces, modes = tube()
    seen = np.array([tuple(polygon.vertices) for polygon in shape.data.polygons])
    assert np.array_equal(np.sort(seen, axis=1), np.sort(faces, axis=1))
    box = np.linalg.norm(np.ptp(positions, axis=0))
    for seconds, q in zip(SECONDS, Q, strict=True):
        frame = seconds * scene.render.fps
        scene.frame_set(int(frame), subframe=frame % 1)
        moved = shape.evaluated_get(bpy.context.evaluated_depsgraph_get())
        points = np.array([moved.matrix_world @ vertex.co for vertex in moved.data.vertices])
        # glTF has y up, Blender z.
        points = points[:, [0, 2, 1]] * [1, 1, -1]
        due = positions + (modes @ q).reshape(-1, 3)
        assert np.abs(points - due).max() < 1e-5 * box, f"at {seconds} s"


SCENE = """
steps_per_second = 2000
duration = 0.2
frames_per_second = 100
response = "penalty"
[models.spring]
shape = "spring-4k"
kind = "linear"
rank = 3
material = { youngs = 1e6, poisson = 0.4, density = 1000 }
[[bodies]]
model = "spring"
position = [0, 0, 1]
velocity = [0.3, 0, 0]
angular_velocity = [1, 0.5, 0]
shake = [40, -50, 60]
"""


def test_blender_keeps_all_weights_of_a_simulation(tmp_path: Path) -> None:
    (tmp_path / "scene.toml").write_text(SCENE)
    out = tmp_path / "out"
    command = [str(COMMAND), "simulate", str(tmp_path / "scene.toml"), "--out", str(out), "--cache", str(tmp_path)]
    subprocess.run(command, check=True, capture_output=True)
    motion = np.load(out / "trajectories.npz")
    q, time = motion["q_spring"][:, 0], motion["time"]
    # Of both signs, and beyond the default range of sliders in Blender.
    assert q.min() < -0.1 and q.max() > 1.5

    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.fps = 100
    assert bpy.ops.import_scene.gltf(filepath=str(out / "animation.glb")) == {"FINISHED"}
    [shape] = [thing for thing in scene.objects if thing.type == "MESH"]
    for seconds in [0.0, 0.05, 0.1, 0.15]:
        scene.frame_set(round(100 * seconds))
        moved = shape.evaluated_get(bpy.context.evaluated_depsgraph_get())
        shown = [key.value for key in moved.data.shape_keys.key_blocks[1:]]
        due = q[np.abs(time - seconds).argmin()]
        assert len(shown) == len(due) == 3
        assert np.allclose(shown, due, rtol=1e-5, atol=1e-5 * np.abs(q).max()), f"at {seconds} s"
