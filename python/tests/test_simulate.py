"""`sscc.simulate` equals the command, reports errors, and resumes."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import threading
import time
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
    summary = json.loads(theirs.stdout)
    for key in ("scene", "objects", "steps", "scene_steps", "colliding_steps", "energy_last"):
        assert ours.summary[key] == summary[key]
    assert ours.folder == tmp_path / "o" and all(file.is_file() for file in ours.files)
    motions = [file for file in ours.files if file.suffix == ".npz"]
    assert motions
    for file in motions:
        with np.load(file) as mine, np.load(tmp_path / "t" / file.name) as other:
            assert sorted(mine) == sorted(other)


def test_errors_name_the_argument(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="did you mean 'spring'"):
        sscc.simulate("sprig", tmp_path / "o")
    with pytest.raises(ValueError, match="^steps is 0"):
        sscc.simulate("spring", tmp_path / "o", steps=0)
    with pytest.raises(TypeError, match="^restart is a int"):
        sscc.simulate("spring", tmp_path / "o", restart=1)  # type: ignore[arg-type]


def test_threads_simulate_at_the_same_time(tmp_path: Path) -> None:
    vertices, faces, _ = torus(24, 12, 1)
    write_obj(tmp_path / "ring.obj", vertices, faces)
    scene, cache = tmp_path / "scene.toml", tmp_path / "cache"
    scene.write_text(SCENE)
    alone = sscc.simulate(scene, tmp_path / "alone", steps=200, cache=cache, threads=1)
    found: dict[str, sscc.Simulation] = {}

    def simulate(name: str) -> None:
        found[name] = sscc.simulate(scene, tmp_path / name, steps=200, cache=cache, threads=1)

    threads = [threading.Thread(target=simulate, args=(name,)) for name in ("a", "b")]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(found) == ["a", "b"]
    motion = (alone.folder / "trajectories.npz").read_bytes()
    assert all((simulation.folder / "trajectories.npz").read_bytes() == motion for simulation in found.values())


def test_the_same_call_resumes_after_ctrl_c(tmp_path: Path) -> None:
    vertices, faces, _ = torus(24, 12, 1)
    write_obj(tmp_path / "ring.obj", vertices, faces)
    scene, cache, out = tmp_path / "scene.toml", tmp_path / "cache", tmp_path / "out"
    scene.write_text(SCENE.replace("duration = 1.0", "duration = 1e4"))
    sscc.simulate(scene, out, steps=1, cache=cache)
    log = out / "states.log"
    before = log.stat().st_size

    def press() -> None:
        while log.stat().st_size <= before:
            time.sleep(0.01)
        os.kill(os.getpid(), signal.SIGINT)

    # A process that a shell started in the background would ignore Ctrl-C.
    handler = signal.signal(signal.SIGINT, signal.default_int_handler)
    presser = threading.Thread(target=press)
    presser.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            sscc.simulate(scene, out, cache=cache)
    finally:
        presser.join()
        signal.signal(signal.SIGINT, handler)
    with np.load(out / "trajectories.npz") as motion:
        stopped = motion["positions"]
    assert len(stopped) > 1
    steps = len(stopped) + 10
    again = sscc.simulate(scene, out, steps=steps, cache=cache)
    assert again.summary["steps"] == steps
    # The factor is unknown: the steps of the earlier call are not timed again.
    assert again.summary["real_time_factor_processor"] is None
    with np.load(out / "trajectories.npz") as motion:
        assert np.array_equal(motion["positions"][: len(stopped)], stopped)
