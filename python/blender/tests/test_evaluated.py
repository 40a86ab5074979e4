"""The evaluated mesh of any object: armatures, modifiers, shape keys. Tested in Blender as a Python module."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

bpy: Any = pytest.importorskip("bpy", reason="Blender as a module (pip install bpy) is not installed")

sys.path.insert(0, str(Path(__file__).parents[1]))
import sscc  # noqa: E402
import sscc_shape_keys  # noqa: E402
from sscc_shape_keys import evaluated, panel  # noqa: E402
from sscc_shape_keys.status import Status, colliding  # noqa: E402


@pytest.fixture(autouse=True)
def addon() -> Iterator[None]:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    sscc_shape_keys.register()
    yield
    sscc_shape_keys.unregister()


def status(obj: Any) -> Status | None:
    return evaluated.status(obj, bpy.context.evaluated_depsgraph_get())


def added(name: str, vertices: np.ndarray, faces: list[tuple[int, ...]]) -> Any:
    """A new active object of that mesh."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([*map(tuple, vertices)], [], faces)
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    return obj


def strip() -> Any:
    """A strip of 24 x 2 quads along y, 6 long."""
    y, x = (part.ravel() for part in np.meshgrid(np.linspace(0, 6, 25), np.linspace(-0.5, 0.5, 3), indexing="ij"))
    faces = [(a, a + 1, a + 4, a + 3) for row in range(24) for a in (3 * row, 3 * row + 1)]
    return added("Strip", np.stack([x, y, 0 * x], axis=1), faces)


def rig(obj: Any) -> Any:
    """An armature of 3 bones along the strip; each vertex follows the nearest."""
    armature = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
    bpy.context.collection.objects.link(armature)
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.mode_set(mode="EDIT")
    parent = None
    for number in range(3):
        bone = armature.data.edit_bones.new(f"Bone{number}")
        bone.head, bone.tail, bone.parent = (0, 2 * number, 0), (0, 2 * number + 2, 0), parent
        parent = bone
    bpy.ops.object.mode_set(mode="OBJECT")
    for number in range(3):
        group = obj.vertex_groups.new(name=f"Bone{number}")
        near = [v.index for v in obj.data.vertices if min(int(v.co.y / 2), 2) == number]
        group.add(near, 1.0, "REPLACE")
    obj.modifiers.new("Armature", "ARMATURE").object = armature
    bpy.context.view_layer.objects.active = obj
    return armature


def bend(armature: Any, degrees: float) -> None:
    """Turns the second and third bones about x."""
    for name in ("Bone1", "Bone2"):
        bone = armature.pose.bones[name]
        bone.rotation_mode = "XYZ"
        bone.rotation_euler.x = math.radians(degrees)
    bpy.context.view_layer.update()


def test_an_armature_bends_a_mesh_into_itself() -> None:
    obj = strip()
    armature = rig(obj)
    assert status(obj) is None
    assert bpy.ops.sscc.check_evaluated() == {"FINISHED"}
    flat = status(obj)
    assert flat is not None and (flat.kind, flat.text) == ("free", "evaluated mesh: free")
    # The third part crosses the first.
    bend(armature, 130)
    changed = status(obj)
    assert changed is not None and changed.kind == "changed"
    assert bpy.ops.sscc.check_evaluated() == {"FINISHED"}
    found = status(obj)
    assert found is not None and found.kind == "colliding" and len(found.polygons) > 0
    assert panel._shown(bpy.context) is found and len(found.corners) % 3 == 0
    assert bpy.ops.sscc.select() == {"FINISHED"}
    chosen = [polygon.index for polygon in obj.data.polygons if polygon.select]
    assert chosen == found.polygons.tolist() and min(chosen) < 16 and max(chosen) >= 32
    # The pose of an earlier check has its answer at once.
    bend(armature, 0)
    again = status(obj)
    assert again is not None and again.kind == "free"


def test_answers_are_those_of_the_evaluated_mesh() -> None:
    obj = strip()
    armature = rig(obj)
    for degrees in (20, 60, 100, 130, 170):
        bend(armature, degrees)
        mesh = evaluated.read(obj, bpy.context.evaluated_depsgraph_get())
        pairs = sscc.self_intersections(mesh.positions, mesh.faces)
        found = evaluated.check(obj, bpy.context.evaluated_depsgraph_get())
        assert (found.kind == "colliding") == (len(pairs) > 0)
        assert found.polygons.tolist() == sorted(set(mesh.polygons[np.unique(pairs)].tolist()))
    assert len(evaluated._detectors) == 1


def test_collisions_are_only_marked_if_modifiers_change_the_faces() -> None:
    obj = strip()
    bend(rig(obj), 130)
    obj.modifiers.new("Subdivision", "SUBSURF").levels = 1
    assert bpy.ops.sscc.check_evaluated() == {"FINISHED"}
    found = status(obj)
    assert found is not None and found.kind == "colliding" and "modifiers change the faces" in found.text
    assert len(found.polygons) == 0 and len(found.corners) > 0
    with pytest.raises(RuntimeError, match="only marked"):
        bpy.ops.sscc.select()


def test_meshes_without_shape_keys_are_checked() -> None:
    corners = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    upright = corners[:, [2, 0, 1]] + [0.5, 0.3, -0.5]
    obj = added("Crossed", np.concatenate([corners, upright]), [(0, 1, 2, 3), (4, 5, 6, 7)])
    assert bpy.ops.sscc.check_evaluated() == {"FINISHED"}
    found = status(obj)
    assert found is not None and found.polygons.tolist() == [0, 1]
    assert found.text.startswith("evaluated mesh: 2 faces collide (")


def test_counts_have_the_right_number() -> None:
    positions, faces = np.zeros((9, 3)), np.arange(9).reshape(3, 3)

    def text(pairs: list[list[int]], polygons: list[int]) -> str:
        return colliding(np.array(pairs), np.array(polygons), positions, faces).text

    assert text([[0, 1]], [0, 0, 0]) == "1 face collides (1 pair of triangles)"
    assert text([[0, 1]], [0, 1, 2]) == "2 faces collide (1 pair of triangles)"
    assert text([[0, 1], [0, 2]], [0, 1, 2]) == "3 faces collide (2 pairs of triangles)"


def test_the_panel_shows_both_answers() -> None:
    shown: list[str] = []

    class Layout:
        def label(self, text: str, icon: str) -> None:
            shown.append(text)

        def prop(self, *_: object) -> None: ...

        def operator(self, name: str) -> None:
            shown.append(name)

    class Panel:
        layout = Layout()

    strip()
    panel.SSCC_PT_panel.draw(Panel(), bpy.context)
    assert "sscc.check_evaluated" in shown and not any("evaluated mesh" in text for text in shown)
    shown.clear()
    bpy.ops.sscc.check_evaluated()
    panel.SSCC_PT_panel.draw(Panel(), bpy.context)
    assert "evaluated mesh: free" in shown and "the mesh has no shape keys beside the basis" in shown


def test_objects_without_faces_are_refused_with_the_reason() -> None:
    empty = bpy.data.objects.new("Empty", None)
    bpy.context.collection.objects.link(empty)
    bpy.context.view_layer.objects.active = empty
    with pytest.raises(RuntimeError, match=r"Empty \(empty\) has no mesh"):
        bpy.ops.sscc.check_evaluated()
    added("Points", np.zeros((3, 3)), [])
    with pytest.raises(RuntimeError, match="the mesh has no faces"):
        bpy.ops.sscc.check_evaluated()
    bpy.context.view_layer.objects.active = None
    with pytest.raises(RuntimeError, match="select an object with a mesh"):
        bpy.ops.sscc.check_evaluated()


def test_vertices_at_infinity_are_refused() -> None:
    obj = strip()
    positions = np.zeros((len(obj.data.vertices), 3), np.float32)
    positions[3, 0] = np.inf
    obj.data.vertices.foreach_set("co", positions.reshape(-1))
    obj.data.update()
    with pytest.raises(RuntimeError, match=r"positions: vertex 3 \(counted from 0\) has the position"):
        bpy.ops.sscc.check_evaluated()
