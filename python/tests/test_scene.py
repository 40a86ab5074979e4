"""``sscc.Scene``: meshes of a glTF file with themselves and with each other."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import sscc
from scenes import character


@pytest.fixture
def scene(tmp_path: Path) -> sscc.Scene:
    return sscc.Scene.load(character(tmp_path))


def test_a_scene_lists_its_nodes_and_animations(scene: sscc.Scene) -> None:
    assert scene.nodes == [
        sscc.SceneNode(0, "body", "torso", 3, 1),
        sscc.SceneNode(2, "shirt", "cotton", 3, 1),
    ]
    assert scene.animations == [sscc.SceneAnimation("wave", 1.0)]


def test_nodes_are_checked_with_each_other(scene: sscc.Scene) -> None:
    # In the stored scene, one mesh is above the other.
    assert [(answer.node, answer.against_node) for answer in scene.check()] == [(0, None), (2, None)]
    found = scene.check("wave", times=[0, 0.6, 1])
    assert [(answer.node_name, answer.time) for answer in found[:6]] == [
        (name, time) for name in ("body", "shirt") for time in (0, 0.6, 1)
    ]
    [between] = found[6:]
    assert (between.node_name, between.against_node_name, between.index) == ("body", "shirt", 1)
    assert between.pairs.tolist() == [[0, 0]] and between.colliding and between.complete
    assert not between.pairs.flags.writeable
    assert len(scene.check(0, times=[0.6], between_nodes=False)) == 2
    assert len(scene.check(clearance=1.25, between_nodes=False)) == 2
    assert [answer.node for answer in scene.check("wave", times=[0.6], node="shirt")] == [2]
    assert [answer.node for answer in scene.check("wave", times=[0.6], node=2)] == [2]

    moving = scene.check("wave", times=[0, 1], continuous=True)
    assert moving[-1].times is not None and abs(moving[-1].times[0] - 0.5) < 1e-9
    near = scene.check(clearance=1.25)
    assert near[-1].against_node == 2 and near[-1].distance == 1 and not near[-1].colliding
    assert near[-1].distances is not None and near[-1].distances.tolist() == [1]


def test_groups_are_names_of_nodes_meshes_and_materials(scene: sscc.Scene) -> None:
    for a in ("body", "torso", "skin"):
        for b in ("shirt", "cotton", "cloth"):
            assert len(scene.check("wave", times=[0.6], ignore_groups=[f"{a},{b}"])) == 2
            assert len(scene.check("wave", times=[0.6], only_groups=f"{b},{a}")) == 3
    assert len(scene.check("wave", times=[0.6], only_groups=["skin,skin"])) == 2
    with pytest.raises(ValueError, match="no triangle is in a group 'skin'; groups: 'body', 'shirt'"):
        scene.check(ignore_groups=["skin,shirt"], group_by="node")


def test_positions_are_those_of_the_player(scene: sscc.Scene) -> None:
    found = scene.positions("shirt", "wave", times=[0, 0.25, 1])
    assert found.shape == (3, 3, 3)
    assert found[:, 0].tolist() == [[1, 1, 1], [1, 1, 0.5], [1, 1, -1]]
    assert scene.positions(0)[0].tolist() == [[0, 0, 0], [4, 0, 0], [0, 4, 0]]
    assert scene.positions("shirt", "wave", fps=4).shape == (5, 3, 3)


def test_progress_is_one_only_at_the_end(scene: sscc.Scene) -> None:
    """The nodes are compared with each other after each with itself."""
    shares: list[float] = []
    answers = scene.check("wave", times=np.linspace(0, 1, 20_000), progress=shares.append)
    assert len(answers) > 40_000
    assert shares == sorted(shares) and shares[-1] == 1.0 and shares.count(1.0) == 1


def test_bad_arguments_are_named(scene: sscc.Scene, tmp_path: Path) -> None:
    refused: list[tuple[Callable[[], object], str]] = [
        (lambda: scene.check("walk"), "no animation 'walk'"),
        (lambda: scene.check("wave", node="hat"), "no node 'hat' shows a mesh with triangles; these nodes do: 0 'body'"),
        (lambda: scene.check(times=[0]), "times and fps are those of an animation"),
        (lambda: scene.check("wave", times=[0], fps=1), "give times or fps, not both"),
        (lambda: scene.check("wave", fps=0), "0 frames per second"),
        (lambda: scene.check("wave", times=[]), "there are no times"),
        (lambda: scene.check(continuous=True), "a scene at rest has no motion"),
        (lambda: scene.check(clearance=0.0), "clearance"),
        (lambda: scene.check("wave", clearance=1.0, continuous=True), "leave out continuous"),
        (lambda: scene.check(ignore_groups=["a,b"], only_groups=["a,b"]), "not both"),
        (lambda: scene.check(clearance=1.0, neighbours="exclude"), "leave out neighbours"),
        (lambda: scene.positions("light"), "no node 'light' shows a mesh"),
    ]
    for call, message in refused:
        with pytest.raises(ValueError, match=message):
            call()
    with pytest.raises(TypeError, match="animation is a float"):
        scene.check(1.0)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match='texts "A,B"'):
        scene.check(only_groups=[("a", "b")])  # type: ignore[list-item]
    with pytest.raises(FileNotFoundError):
        sscc.Scene.load(tmp_path / "none.glb")
    (tmp_path / "bad.gltf").write_text("{")
    with pytest.raises(ValueError, match=r"bad\.gltf"):
        sscc.Scene.load(tmp_path / "bad.gltf")


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_answers_are_those_of_the_command(models: Path, command: Path) -> None:
    path = models / "skinned" / "RobotExpressive.glb"
    scene = sscc.Scene.load(path)
    arguments = ["check", str(path), "--animation=Dance", "--times=0.3,0.8", "--between-nodes", "--json"]
    run = subprocess.run([str(command), *arguments], capture_output=True, text=True)
    lines = [json.loads(line) for line in run.stdout.splitlines()]
    found = scene.check("Dance", times=[0.3, 0.8])
    assert len(found) == len(lines) > 40
    for answer, line in zip(found, lines):
        assert (answer.node, answer.time) == (line["node"], line["time"])
        assert answer.node_name == line.get("node_name", answer.node_name)
        assert answer.against_node == line.get("against_node")
        assert answer.pairs.tolist() == line["pairs"]
