"""The installed package: its metadata, its types, its licences, and versions that are stated in several files."""

from __future__ import annotations

import importlib.metadata
import re
import tomllib

import sscc
from conftest import PROJECT

LICENCES = ["LICENSE-APACHE", "LICENSE-MIT"]


def test_metadata_types_and_licences_are_in_the_wheel() -> None:
    package = importlib.metadata.distribution("sscc")
    facts = package.metadata
    assert facts["Requires-Python"] == ">=3.11" and facts["License-Expression"] == "MIT OR Apache-2.0"
    assert facts["Description-Content-Type"].startswith("text/markdown")
    assert "pip install" in facts["Description"]
    assert sorted(facts.get_all("License-File") or []) == LICENCES
    files = {str(file): file for file in package.files or []}
    assert {"sscc/py.typed", "sscc/_sscc.pyi"} <= set(files)
    for licence in LICENCES:
        [inside] = [file for name, file in files.items() if name.endswith(f"licenses/{licence}")]
        assert inside.read_text() == (PROJECT / licence).read_text()
    assert not [name for name in files if name.startswith(("tests", "examples", "benches", "blender"))]


def test_all_files_state_one_version() -> None:
    version = tomllib.loads((PROJECT / "Cargo.toml").read_text())["workspace"]["package"]["version"]
    manifest = tomllib.loads((PROJECT / "python/blender/sscc_shape_keys/blender_manifest.toml").read_text())
    assert sscc.__version__ == manifest["version"] == version
    for name, pattern in [
        ("CITATION.cff", r"^version: (.*)$"),
        ("python/conda/recipe.yaml", r"^  version: (\d.*)$"),
        ("CHANGELOG.md", r"^## (\d[\d.]*)"),
    ]:
        found = re.search(pattern, (PROJECT / name).read_text(), flags=re.MULTILINE)
        assert found and found[1] == version, name
