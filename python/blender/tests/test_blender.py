"""The Blender add-on, tested in Blender as a Python module."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

bpy: Any = pytest.importorskip("bpy", reason="Blender as a module (pip install bpy) is not installed")

sys.path.insert(0, str(Path(__file__).parents[1]))
import sscc_shape_keys  # noqa: E402
from sscc_shape_keys import panel, proof, shape  # noqa: E402


@pytest.fixture(autouse=True)
def addon() -> Iterator[None]:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    sscc_shape_keys.register()
    yield
    sscc_shape_keys.unregister()


def jaws() -> Any:
    """Two plates of 6 x 6 quads, 1 apart, with the keys Close (the upper falls by 2), Lift and Tilt, all of the upper
    plate."""
    side = np.arange(7) / 6
    x, y = (part.ravel() for part in np.meshgrid(side, side))
    lower = np.stack([x, y, 0 * x], axis=1)
    upper = lower + [0.05, 0.03, 1]
    quads = [(a, a + 1, a + 8, a + 7) for row in range(6) for a in range(7 * row, 7 * row + 6)]
    faces = quads + [tuple(v + 49 for v in quad) for quad in quads]
    mesh = bpy.data.meshes.new("Jaws")
    mesh.from_pydata([*map(tuple, lower), *map(tuple, upper)], [], faces)
    obj = bpy.data.objects.new("Jaws", mesh)
    bpy.context.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    obj.shape_key_add(name="Basis")
    for name, move in [("Close", 0 * x - 2), ("Lift", 0 * x + 0.5), ("Tilt", 0.4 * x)]:
        key = obj.shape_key_add(name=name, from_mix=False)
        key.value = 0  # the initial value is 0 in some versions, 1 in others
        for vertex, dz in enumerate(move, 49):
            key.points[vertex].co.z += dz
    return obj


def status(obj: Any) -> proof.Status:
    """Returns the status, after a check that the panel shows it."""
    shown: list[str] = []

    class Layout:
        def label(self, text: str, icon: str) -> None:
            shown.append(text)

        def prop(self, *_: object) -> None: ...

        def operator(self, *_: object) -> None: ...

    class Panel:
        layout = Layout()

    panel.SSCC_PT_panel.draw(Panel(), bpy.context)
    found = proof.status(obj, bpy.context.scene.sscc_ignore_rest)
    assert shown == [found.text]
    assert ("free (proven)" in found.text) == (found.kind == "free")
    return found


def evaluated(obj: Any) -> np.ndarray:
    """The positions of the vertices by Blender."""
    found = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    positions = np.empty((len(found.vertices), 3), np.float32)
    found.vertices.foreach_get("co", positions.reshape(-1))
    return positions


def keys(obj: Any) -> Any:
    return obj.data.shape_keys.key_blocks


def test_colliding_faces_follow_the_sliders() -> None:
    obj = jaws()
    assert status(obj).kind == "uncertified"
    assert bpy.ops.sscc.certify() == {"FINISHED"}
    assert status(obj).kind == "free"
    kinds = []
    for value in np.linspace(0, 1, 21):
        keys(obj)["Close"].value = value
        found = status(obj)
        kinds.append(found.kind)
        heights = evaluated(obj)[49:, 2]
        assert (found.kind == "colliding") == (heights.min() <= 0 <= heights.max()), value
        if found.kind == "colliding":
            assert bpy.ops.sscc.select() == {"FINISHED"}
            chosen = [polygon.index for polygon in obj.data.polygons if polygon.select]
            assert chosen == found.polygons.tolist()
            # Both plates, and each triangle of the mark is one of the shape's.
            assert min(chosen) < 36 <= max(chosen)
            assert found.corners.shape[0] % 3 == 0 and found.corners[:, 2].max() <= heights.max() + 1e-6
    assert set(kinds) == {"free", "colliding"}
    # They touch when Close is 0.5 exactly, and the tilt opens them.
    keys(obj)["Close"].value = 0.5
    assert status(obj).kind == "colliding"
    keys(obj)["Tilt"].value = 1
    keys(obj)["Lift"].value = 0.25
    assert status(obj).kind == "free"


def test_positions_equal_those_of_blender() -> None:
    """For keys relative to other keys, muted keys, and negative and large values."""
    obj = jaws()
    keys(obj)["Tilt"].relative_key = keys(obj)["Lift"]
    keys(obj)["Lift"].relative_key = keys(obj)["Close"]
    for key in keys(obj)[1:]:
        key.slider_min, key.slider_max = -5, 5
    assert bpy.ops.sscc.certify() == {"FINISHED"}
    certified = proof._known[shape.read(obj).fingerprint(), False]
    random = np.random.default_rng(0)
    for case in range(20):
        for key in keys(obj)[1:]:
            key.value = random.uniform(-5, 5)
        keys(obj)["Lift"].mute = case % 3 == 0
        bpy.context.view_layer.update()
        positions = certified.certificates.model.positions(shape.values(obj))
        assert np.abs(positions - evaluated(obj)).max() < 1e-4
        assert status(obj).kind in ("free", "colliding")


def edits(obj: Any) -> dict[str, Any]:
    """Edits after which there must be no answer, each with its undo."""
    key, basis = keys(obj)["Close"], keys(obj)["Basis"]

    def move(point: Any, by: float) -> None:
        point.co.z += by

    def add() -> None:
        obj.shape_key_add(name="More", from_mix=False)

    def modifier(on: bool) -> None:
        if on:
            obj.modifiers.new("Wave", "WAVE")
        else:
            obj.modifiers.clear()

    def set_of(owner: Any, name: str, new: Any) -> tuple[Any, Any]:
        old = getattr(owner, name)
        return lambda: setattr(owner, name, new), lambda: setattr(owner, name, old)

    group = obj.vertex_groups.new(name="Half")
    group.add(range(49, 70), 0.5, "REPLACE")
    return {
        "a sculpted basis": (lambda: move(basis.points[50], 0.25), lambda: move(basis.points[50], -0.25)),
        "a moved key": (lambda: move(key.points[50], 0.25), lambda: move(key.points[50], -0.25)),
        "another relative key": set_of(key, "relative_key", keys(obj)["Lift"]),
        "a modifier": (lambda: modifier(True), lambda: modifier(False)),
        "a vertex group": (lambda: setattr(key, "vertex_group", "Half"), lambda: setattr(key, "vertex_group", "")),
        "absolute keys": set_of(obj.data.shape_keys, "use_relative", False),
        "only the active key": set_of(obj, "show_only_shape_key", True),
        "one key more": (add, lambda: obj.shape_key_remove(keys(obj)["More"])),
        "edit mode": (
            lambda: bpy.ops.object.mode_set(mode="EDIT"),
            lambda: bpy.ops.object.mode_set(mode="OBJECT"),
        ),
        "sculpt mode": (
            lambda: bpy.ops.object.mode_set(mode="SCULPT"),
            lambda: bpy.ops.object.mode_set(mode="OBJECT"),
        ),
    }


def test_an_edit_invalidates_the_certificates() -> None:
    obj = jaws()
    assert bpy.ops.sscc.certify() == {"FINISHED"}
    for name, (edit, undo) in edits(obj).items():
        assert status(obj).kind == "free", name
        edit()
        found = status(obj)
        assert found.kind in ("changed", "unsupported"), name
        if found.kind == "changed":
            assert "certify again" in found.text
        assert bpy.ops.sscc.select.poll() and found.polygons.size == 0
        undo()
    # The shape is the certified one again.
    assert status(obj).kind == "free"


def test_deleting_a_vertex_invalidates_the_certificates() -> None:
    obj = jaws()
    assert bpy.ops.sscc.certify() == {"FINISHED"}
    import bmesh

    work = bmesh.new()
    work.from_mesh(obj.data)
    work.verts.ensure_lookup_table()
    bmesh.ops.delete(work, geom=[work.verts[0]], context="VERTS")
    work.to_mesh(obj.data)
    work.free()
    assert status(obj).kind == "changed"
    assert bpy.ops.sscc.certify() == {"FINISHED"}
    assert status(obj).kind == "free"


def test_muted_keys_count_as_zero() -> None:
    obj = jaws()
    assert bpy.ops.sscc.certify() == {"FINISHED"}
    close, lift = keys(obj)["Close"], keys(obj)["Lift"]
    close.value, lift.value = 0.75, 1  # the plates lie in one plane
    assert status(obj).kind == "colliding"
    lift.mute = True
    assert status(obj).kind == "free"
    lift.mute = False
    assert status(obj).kind == "colliding"
    close.mute = True
    assert status(obj).kind == "free"


def test_values_beyond_the_sliders_have_answers() -> None:
    obj = jaws()
    assert bpy.ops.sscc.certify() == {"FINISHED"}
    close = keys(obj)["Close"]
    close.value = 3
    assert close.value == 1 and status(obj).kind == "free"  # far below the other plate
    close.slider_max = 3
    for frame, value in [(1, 0.25), (2, 0.5), (3, 2.5)]:
        close.value = value
        close.keyframe_insert("value", frame=frame)
    for frame, kind in [(1, "free"), (2, "colliding"), (3, "free")]:
        bpy.context.scene.frame_set(frame)
        assert status(obj).kind == kind, frame
    assert evaluated(obj)[49, 2] == pytest.approx(-4)


def test_collisions_of_the_basis_can_be_ignored() -> None:
    obj = jaws()
    for point in list(keys(obj)["Basis"].points)[49:]:
        point.co.z -= 1
    for key in keys(obj)[1:]:
        for point in list(key.points)[49:]:
            point.co.z -= 1
    assert bpy.ops.sscc.certify() == {"FINISHED"}
    assert status(obj).kind == "colliding"
    bpy.context.scene.sscc_ignore_rest = True
    assert status(obj).kind == "changed"
    assert bpy.ops.sscc.certify() == {"FINISHED"}
    found = status(obj)
    assert found.kind == "free" and "apart from" in found.text


def test_unsupported_objects_state_the_reason() -> None:
    assert status(None).text == "select a mesh"
    with pytest.raises(RuntimeError, match="select a mesh"):
        bpy.ops.sscc.certify()
    obj = jaws()
    obj.shape_key_clear()
    assert "no shape keys" in status(obj).text
    with pytest.raises(RuntimeError, match="no shape keys"):
        bpy.ops.sscc.certify()
    with pytest.raises(RuntimeError, match="no shape keys"):
        bpy.ops.sscc.select()


def test_triangles_are_those_of_blender() -> None:
    """For an L-shaped polygon: a fan from its first corner would leave the polygon."""
    mesh = bpy.data.meshes.new("L")
    mesh.from_pydata([(0, 0, 0), (2, 0, 0), (2, 1, 0), (1, 1, 0), (1, 2, 0), (0, 2, 0)], [], [(2, 3, 4, 5, 0, 1)])
    obj = bpy.data.objects.new("L", mesh)
    bpy.context.collection.objects.link(obj)
    obj.shape_key_add(name="Basis")
    obj.shape_key_add(name="Up").points[0].co.z = 1
    found = shape.read(obj)
    faces, polygons = shape.triangles(obj, found)
    a, b, c = (found.basis[faces[:, corner], :2].astype(float) for corner in range(3))
    areas = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    assert (areas > 0).all() and areas.sum() / 2 == 3
    assert polygons.tolist() == [0, 0, 0, 0]
    assert len(bpy.data.meshes) == 1
