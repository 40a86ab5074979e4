"""Self-intersections equal libigl's exact ones, on every real mesh as it is and in random poses.

libigl omits contacts at coincident vertices: pairs of triangles that meet at vertices of equal position and different
number. The tests verify that each omitted pair is such a contact.
"""

from __future__ import annotations

import os
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

import exact
import sscc
from poses import FILES, mesh

#: Number of poses of each mesh among 125 poses. It is low for large meshes, for which libigl takes seconds.
SHARES = {
    "bunny_69451": 1,
    "dragon_77202": 1,
    "bunny_69664": 1,
    "ict_face": 2,
    "bunny_14964": 4,
    "bunny_6966": 8,
    "doubleLoopWithCube": 10,
    "vega_A": 20,
    "AnimatedMorphSphere": 12,
    "MorphStressTest": 8,
    "RobotExpressive head": 8,
    "Fox": 14,
    "CesiumMan": 10,
    "greenman": 10,
    "RobotExpressive right hand": 8,
    "RobotExpressive left hand": 8,
}
#: The mesh of each pose; the order repeats.
NAMES = [name for name, share in SHARES.items() for _ in range(share)]
#: The first pose of each mesh, and more for meshes with many poses: about a sixteenth of all.
FEW = [number for number, name in enumerate(NAMES) if 4 * NAMES[:number].count(name) < SHARES[name]]
#: The poses to test: with CI=true all 500.
POSES = list(range(500)) if os.environ.get("CI") == "true" else FEW


def test_each_difference_is_listed() -> None:
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], float)
    x = np.concatenate([corners, -corners, corners + [0.25, 0.25, 0], corners + [9, 9, 9]])
    f = np.arange(12).reshape(-1, 3)
    found = sscc.self_intersections(x, f)
    assert found.tolist() == [[0, 1], [0, 2]]  # the first at coincident vertices
    assert exact.unexplained(x, f, found, found[1:]) == ([], 1)
    assert exact.unexplained(x, f, found, found[:1]) == (["only sscc lists [0, 2]"], 0)
    libigl = np.array([[0, 1], [0, 2], [2, 3]], np.uint32)
    assert exact.unexplained(x, f, found, libigl) == (["only libigl lists [2, 3]"], 0)
    # A pair with a common vertex is not such a contact.
    assert not exact.meets_at_coincident_vertices(x, np.array([[0, 1, 2], [0, 3, 4]]), found[:1]).any()


@pytest.mark.usefixtures("libigl")
def test_real_meshes_as_they_are(models: Path) -> None:
    meshes = [mesh(models, name) for name in FILES]
    answers = exact.libigl_answers((some.vertices, some.faces) for some in meshes)
    wrong, at_coincident = [], Counter[str]()
    for some, libigl in zip(meshes, answers, strict=True):
        found = sscc.self_intersections(some.vertices, some.faces)
        these, at_coincident[some.name] = exact.unexplained(some.vertices, some.faces, found, libigl)
        wrong += [f"{some.name}: {difference}" for difference in these]
    assert not wrong, "\n".join(wrong)
    # Most glTF files split vertices for rendering, so they have vertices of equal position.
    split = {name for name, (file, _) in FILES.items() if file.endswith((".glb", ".gltf"))}
    assert {name for name, count in at_coincident.items() if count > 0} == split - {"SimpleSkin", "Animation_Skin_10"}


@pytest.mark.usefixtures("libigl")
def test_random_poses(models: Path) -> None:
    meshes = [mesh(models, NAMES[number % len(NAMES)]) for number in POSES]
    poses = [some.pose(number) for some, number in zip(meshes, POSES, strict=True)]
    answers = exact.libigl_answers((x, some.faces) for some, x in zip(meshes, poses, strict=True))
    detectors = {some.name: sscc.Detector(some.faces, some.vertices) for some in meshes}
    wrong, colliding, pairs, at_coincident = [], 0, 0, 0
    for number, some, x, libigl in zip(POSES, meshes, poses, answers, strict=True):
        found = detectors[some.name].check(x).pairs
        these, count = exact.unexplained(x, some.faces, found, libigl)
        if not np.array_equal(found, sscc.self_intersections(x, some.faces)):
            these.append("a detector and self_intersections differ")
        wrong += [f"pose {number}, {some.name}: {difference}" for difference in these]
        colliding, pairs, at_coincident = colliding + (len(libigl) > 0), pairs + len(found), at_coincident + count
    print(f"{len(POSES)} poses, {colliding} colliding, {pairs} pairs, {at_coincident} of them at coincident vertices alone")
    assert not wrong, "\n".join(wrong)
    assert colliding > len(POSES) / 2 and pairs - at_coincident > 100 * len(POSES) and at_coincident > 0
