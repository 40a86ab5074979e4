"""Simulations from Python."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import numpy as np
import pytest

import sscc
from shapes import torus, write_obj

#: A small ring falls on the ground.
SCENE = """
steps_per_second = 1000
duration = 1.0
gravity = [0, 0, -9.81]
[ground]
[models.ring]
file = "ring.obj"
resolution = 12
kind = "linear"
rank = 4
[[bodies]]
model = "ring"
position = [0, 0, 0.5]
"""


def test_simulations_equal_the_commands(tmp_path: Path, command: Path) -> None:
    vertices, faces, _ = torus(24, 12, 1)
    write_obj(tmp_path / "ring.obj", vertices, faces)
    scene, cache = tmp_path / "scene.toml", tmp_path / "cache"
    scene.write_text(SCENE)
    theirs = subprocess.run(
        [command, "simulate", scene, "--out", tmp_path / "t", "--steps", "10", "--cache", cache, "--json"],
        capture_output=True,
    )
    assert theirs.returncode == 0, theirs.stderr
    ours = sscc.simulate(scene, tmp_path / "o", steps=10, cache=cache)
    told = json.loads(theirs.stdout)
    for key in ("scene", "objects", "steps", "scene_steps", "colliding_steps", "energy_last"):
        assert ours.summary[key] == told[key]
    assert ours.folder == tmp_path / "o" and all(file.is_file() for file in ours.files)
    motions = [file for file in ours.files if file.suffix == ".npz"]
    assert motions
    for file in motions:
        with np.load(file) as mine, np.load(tmp_path / "t" / file.name) as other:
            assert sorted(mine) == sorted(other)


def test_what_is_wrong_is_named(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="did you mean 'spring'"):
        sscc.simulate("sprig", tmp_path / "o")
    with pytest.raises(ValueError, match="^steps is 0"):
        sscc.simulate("spring", tmp_path / "o", steps=0)
    with pytest.raises(TypeError, match="^restart is a int"):
        sscc.simulate("spring", tmp_path / "o", restart=1)  # type: ignore[arg-type]
