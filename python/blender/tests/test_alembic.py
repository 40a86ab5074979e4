"""The command of docs/python.md that converts Alembic to USD."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

bpy: Any = pytest.importorskip("bpy", reason="Blender as a module (pip install bpy) is not installed")

GUIDE = Path(__file__).parents[3] / "docs" / "python.md"


def test_the_command_of_the_guide_converts_a_cache(tmp_path: Path) -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    mesh = bpy.data.meshes.new("Cloth")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [], [(0, 1, 2, 3)])
    cloth = bpy.data.objects.new("Cloth", mesh)
    bpy.context.collection.objects.link(cloth)
    cloth.shape_key_add(name="Basis")
    key = cloth.shape_key_add(name="up")
    key.data[2].co.z = 1
    for frame, value in [(1, 0), (3, 1)]:
        key.value = value
        key.keyframe_insert("value", frame=frame)
    bpy.ops.wm.alembic_export(filepath=str(tmp_path / "cloth.abc"), start=1, end=3)

    [code] = re.findall(r'^python -c "(import bpy; .*alembic_import.*)"$', GUIDE.read_text(), re.MULTILINE)
    subprocess.run([sys.executable, "-c", code], cwd=tmp_path, check=True, capture_output=True)

    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.usd_import(filepath=str(tmp_path / "cloth.usdc"))
    [found] = [thing for thing in bpy.data.objects if thing.type == "MESH"]
    heights = []
    for frame in (1, 3):
        bpy.context.scene.frame_set(frame)
        shape = found.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
        heights.append(max(vertex.co.z for vertex in shape.vertices))
    assert heights == [0, 1]
