"""The add-on as an extension: packed, validated and installed by Blender's own tools, and used without the package sscc
in the environment."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest

bpy_found = importlib.util.find_spec("bpy")
if bpy_found is None:
    pytest.skip("Blender as a module (pip install bpy) is not installed", allow_module_level=True)
assert bpy_found.origin is not None
BPY = Path(bpy_found.origin).parent

FOLDER = Path(__file__).parents[1]
# The wheel that the tests have installed.
WHEELS = sorted((FOLDER.parent / ".venv/wheels").glob("*.whl"))
pytestmark = pytest.mark.skipif(not WHEELS, reason="there is no wheel in python/.venv/wheels")

INSTALLED = """
import sys
from pathlib import Path
import bpy

package, folder = sys.argv[1:]
assert bpy.ops.extensions.package_install_files(filepath=package, repo="user_default", enable_on_install=True) == {"FINISHED"}
import sscc
assert Path(sscc.__file__).is_relative_to(folder), sscc.__file__
assert hasattr(bpy.ops.sscc, "certify")

# Two triangles. The key moves the upper one through the lower one; at 0.5 both are in one plane.
mesh = bpy.data.meshes.new("Two")
mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1)], [], [(0, 1, 2), (3, 4, 5)])
obj = bpy.data.objects.new("Two", mesh)
bpy.context.collection.objects.link(obj)
bpy.context.view_layer.objects.active = obj
obj.shape_key_add(name="Basis")
key = obj.shape_key_add(name="Down", from_mix=False)
key.value = 0
for vertex in (3, 4, 5):
    key.points[vertex].co.z -= 2
assert bpy.ops.sscc.certify() == {"FINISHED"}
from bl_ext.user_default.sscc_shape_keys import proof
found = []
for value in (0, 0.25, 0.5, 1):
    key.value = value
    found.append(proof.status(obj, False).kind)
print(*found)
"""


def run(*arguments: object, **variables: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, env={**os.environ, **variables})


def packed(out: Path) -> Path:
    built = run(FOLDER / "build_extension.py", "--out", out, *WHEELS)
    assert built.returncode == 0, built.stderr
    return Path(built.stdout.strip())


def test_blender_validates_the_extension(tmp_path: Path) -> None:
    package = packed(tmp_path)
    [tool] = BPY.glob("*/scripts/addons_core/bl_pkg/cli/blender_ext.py")
    validated = run(tool, "validate", package)
    assert validated.returncode == 0, validated.stdout + validated.stderr
    names = zipfile.ZipFile(package).namelist()
    assert {"blender_manifest.toml", "__init__.py", "LICENSE-MIT", f"wheels/{WHEELS[0].name}"} <= set(names)
    assert package.read_bytes() == packed(tmp_path / "again").read_bytes()
    # Blender's tool finds a defect of the manifest.
    damaged = tmp_path / "damaged.zip"
    with zipfile.ZipFile(package) as whole, zipfile.ZipFile(damaged, "w") as part:
        for name in names:
            part.writestr(name, whole.read(name).replace(b'type = "add-on"', b'type = "addition"'))
    assert run(tool, "validate", damaged).returncode != 0


def test_blender_installs_the_extension_and_answers(tmp_path: Path) -> None:
    package, user, modules = packed(tmp_path), tmp_path / "user", tmp_path / "modules"
    modules.mkdir()
    # A search path with Blender and NumPy, but without the package sscc.
    for name in [BPY.name, "numpy", "numpy.libs"]:
        found = BPY if name == BPY.name else Path(np.__file__).parents[1] / name
        (modules / name).symlink_to(found)
    (tmp_path / "installed.py").write_text(INSTALLED)
    variables = {"PYTHONPATH": str(modules), "BLENDER_USER_RESOURCES": str(user)}
    installed = run("-S", tmp_path / "installed.py", package, user, **variables)
    assert installed.returncode == 0, installed.stdout + installed.stderr
    assert installed.stdout.splitlines()[-1] == "free free colliding free"


@pytest.mark.parametrize(
    "names, cause",
    [
        (["sscc-0.1.0-cp311-abi3-win32.whl"], "Blender has no platform for the tag win32"),
        (["sscc-0.0.9-cp311-abi3-win_amd64.whl"], "expected a wheel of sscc 0.1.0"),
        (["sscc-0.1.0-cp312-cp312-win_amd64.whl"], "expected a wheel of sscc 0.1.0 for cp311-abi3"),
        (["sscc-0.1.0-cp311-abi3-win_amd64.whl", "other/sscc-0.1.0-cp311-abi3-win_amd64.whl"], "two wheels for one"),
        (["missing.whl"], "missing.whl: not found"),
    ],
)
def test_wrong_wheels_are_refused(names: list[str], cause: str, tmp_path: Path) -> None:
    wheels = [tmp_path / name for name in names]
    for wheel in wheels:
        wheel.parent.mkdir(exist_ok=True)
        if wheel.name != "missing.whl":
            wheel.write_bytes(b"")
    refused = run(FOLDER / "build_extension.py", "--out", tmp_path / "out", *wheels)
    assert refused.returncode == 1 and refused.stderr.startswith("error: ") and cause in refused.stderr
    assert refused.stderr.count("\n") == 1 and not (tmp_path / "out").exists()
