"""``sscc.from_usd``: meshes of USD files, with transforms, time samples and skins."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

import sscc

pytestmark = pytest.mark.usefixtures("usd")

CLOTH = """#usda 1.0
( timeCodesPerSecond = 10 )
def Xform "Body" {
    double3 xformOp:translate = (0, 0, 1)
    uniform token[] xformOpOrder = ["xformOp:translate"]
    def Mesh "Cloth" {
        int[] faceVertexCounts = [4, 3]
        int[] faceVertexIndices = [0, 1, 2, 3, 4, 5, 6]
        point3f[] points.timeSamples = {
            0: [(0,0,0), (4,0,0), (4,4,0), (0,4,0), (1,1,1), (2,1,1), (1,1,2)],
            5: [(0,0,0), (4,0,0), (4,4,0), (0,4,0), (1,1,-0.5), (2,1,-0.5), (1,1,0.5)],
        }
    }
}
"""


def write(folder: Path, text: str, name: str = "a.usda") -> Path:
    path = folder / name
    path.write_text(text)
    return path


def test_frames_are_those_of_the_stage(tmp_path: Path) -> None:
    mesh = sscc.from_usd(write(tmp_path, CLOTH))
    assert mesh.name == "/Body/Cloth" and mesh.times.tolist() == [0, 0.5]
    assert mesh.faces.tolist() == [[0, 1, 2], [0, 2, 3], [4, 5, 6]]
    assert mesh.frames.shape == (2, 7, 3)
    assert mesh.frames[:, :, 2].min(axis=1).tolist() == [1, 0.5] and mesh.frames[0, 4].tolist() == [1, 1, 2]
    found = sscc.Detector(mesh.faces, mesh.frames[0]).check_many(mesh.frames)
    assert found.colliding.tolist() == [False, True]
    assert repr(mesh) == "<sscc.UsdMesh: '/Body/Cloth', 3 triangles, 2 frames>"


def test_a_mesh_that_stands_has_one_frame_and_may_be_named(tmp_path: Path) -> None:
    points = "point3f[] points = [(0,0,0), (1,0,0), (0,1,0)]"
    still = f'def Mesh "{{}}" {{{{\nint[] faceVertexCounts = [3]\nint[] faceVertexIndices = [0, 1, 2]\n{points}\n}}}}\n'
    path = write(tmp_path, "#usda 1.0\n" + still.format("A") + still.format("B"))
    assert sscc.from_usd(path, "/B").frames.shape == (1, 3, 3)
    with pytest.raises(ValueError, match=r"a\.usda: the file has 2 meshes: choose one by prim: '/A', '/B'"):
        sscc.from_usd(path)
    with pytest.raises(ValueError, match="no mesh has the path '/C'; the paths are '/A', '/B'"):
        sscc.from_usd(path, "/C")


def test_bad_files_are_named(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        sscc.from_usd(tmp_path / "none.usda")
    with pytest.raises(ValueError, match=r"bad\.usda: USD cannot read it"):
        sscc.from_usd(write(tmp_path, "#usda 1.0\ndef Mesh {", "bad.usda"))
    with pytest.raises(ValueError, match=r"empty\.usda: the file has no prim of type Mesh"):
        sscc.from_usd(write(tmp_path, "#usda 1.0\n", "empty.usda"))
    with pytest.raises(OSError, match="is a directory, a file was expected"):
        sscc.from_usd(tmp_path)
    for bad, message in [
        (CLOTH.replace("[4, 3]", "[4, 4]"), "more corners than are given"),
        (CLOTH.replace("[4, 3]", "[5, 2]"), "needs at least 3 corners"),
        (CLOTH.replace("4, 5, 6]\n", "4, 5, 7]\n"), "names vertex 7"),
        (CLOTH.replace("4, 5, 6]\n", "4, 5, -1]\n"), "has the negative number -1"),
        (CLOTH.replace("(2,1,-0.5), (1,1,0.5)", "(2,1,-0.5)"), "the mesh has 7 points at first, 6 at time code 5"),
        (CLOTH.replace("int[] faceVertexCounts = [4, 3]", "int[] faceVertexCounts.timeSamples = {0: [4, 3], 1: [3, 4]}"), "change over time"),
    ]:
        with pytest.raises(ValueError, match=message):
            sscc.from_usd(write(tmp_path, bad, "b.usda"))


@pytest.mark.skipif(os.name == "nt", reason="names of files cannot have line breaks")
def test_paths_in_messages_are_on_one_line(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"a\\nb\.usda: ") as error:
        sscc.from_usd(write(tmp_path, "#usda 1.0\n", "a\nb.usda"))
    assert "\n" not in str(error.value)


def test_concave_polygons_have_their_own_surface(tmp_path: Path) -> None:
    # The surface of the arrow differs from a fan of triangles at its first corner.
    points = "(2,0,0), (0,1,0), (1,0,0), (0,-1,0)"
    arrow = f'#usda 1.0\ndef Mesh "A" {{\nint[] faceVertexCounts = [4]\nint[] faceVertexIndices = [1, 2, 3, 0]\npoint3f[] points = [{points}]\n}}\n'
    mesh = sscc.from_usd(write(tmp_path, arrow))
    assert sorted(map(sorted, mesh.faces.tolist())) == [[0, 1, 2], [0, 2, 3]]


def test_skins_are_evaluated(tmp_path: Path) -> None:
    skinned = """#usda 1.0
( timeCodesPerSecond = 1 )
def SkelRoot "Root" {
    def Skeleton "Skel" (
        prepend apiSchemas = ["SkelBindingAPI"]
    )
    {
        uniform token[] joints = ["J"]
        uniform matrix4d[] bindTransforms = [((1,0,0,0),(0,1,0,0),(0,0,1,0),(0,0,0,1))]
        uniform matrix4d[] restTransforms = [((1,0,0,0),(0,1,0,0),(0,0,1,0),(0,0,0,1))]
        rel skel:animationSource = </Root/Skel/Anim>
        def SkelAnimation "Anim" {
            uniform token[] joints = ["J"]
            quatf[] rotations = [(1, 0, 0, 0)]
            half3[] scales = [(1, 1, 1)]
            float3[] translations.timeSamples = { 0: [(0, 0, 0)], 1: [(0, 0, 3)] }
        }
    }
    def Mesh "M" (
        prepend apiSchemas = ["SkelBindingAPI"]
    )
    {
        int[] faceVertexCounts = [3]
        int[] faceVertexIndices = [0, 1, 2]
        point3f[] points = [(0,0,0), (1,0,0), (0,1,0)]
        rel skel:skeleton = </Root/Skel>
        int[] primvars:skel:jointIndices = [0, 0, 0] (
            elementSize = 1
            interpolation = "vertex"
        )
        float[] primvars:skel:jointWeights = [1, 1, 1] (
            elementSize = 1
            interpolation = "vertex"
        )
    }
}
"""
    mesh = sscc.from_usd(write(tmp_path, skinned))
    assert mesh.times.tolist() == [0, 1]
    # A mesh whose skin cannot be evaluated is refused, instead of being shown at rest.
    for bad in [
        skinned.replace("        uniform matrix4d[] bindTransforms = [((1,0,0,0),(0,1,0,0),(0,0,1,0),(0,0,0,1))]\n", ""),
        skinned.replace("jointIndices = [0, 0, 0]", "jointIndices = [0, 0, 7]"),
        skinned.replace("jointWeights = [1, 1, 1]", "jointWeights = [1, 1]"),
    ]:
        assert bad != skinned
        with pytest.raises(ValueError, match=r"/Root/M: USD cannot evaluate its skin"):
            sscc.from_usd(write(tmp_path, bad, f"bad{len(bad)}.usda"))
    assert np.allclose(mesh.frames[:, :, 2], [[0, 0, 0], [3, 3, 3]])


def test_instances_are_meshes(tmp_path: Path) -> None:
    mesh = 'def Mesh "m" {\nint[] faceVertexCounts = [3]\nint[] faceVertexIndices = [0, 1, 2]\npoint3f[] points = [(0,0,0), (1,0,0), (0,1,0)]\n}'
    instance = (
        'def Xform "I" (\ninstanceable = true\nreferences = </P>\n)\n'
        '{\ndouble3 xformOp:translate = (0, 0, 5)\nuniform token[] xformOpOrder = ["xformOp:translate"]\n}'
    )
    path = write(tmp_path, f'#usda 1.0\ndef Xform "P" {{\n{mesh}\n}}\n{instance}\n')
    with pytest.raises(ValueError, match="the file has 2 meshes: choose one by prim: '/P/m', '/I/m'"):
        sscc.from_usd(path)
    assert sscc.from_usd(path, "/I/m").frames[0, :, 2].tolist() == [5, 5, 5]
    instancer = f'#usda 1.0\n{mesh}\ndef PointInstancer "many" {{\n}}\n'
    with pytest.warns(UserWarning, match="/many: a PointInstancer is not evaluated"):
        sscc.from_usd(write(tmp_path, instancer, "b.usda"))
