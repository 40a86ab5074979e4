"""The examples of docs/python.md run, and what the first pages of the site show."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from conftest import PROJECT
from scenes import character
from shapes import write_obj

#: A bar of 60 x 8 x 20 mm.
BRACKET = """v 0 0 0\nv 60 0 0\nv 60 8 0\nv 0 8 0\nv 0 0 20\nv 60 0 20\nv 60 8 20\nv 0 8 20
f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n"""


def blocks(page: str) -> list[str]:
    text = (PROJECT / page).read_text(encoding="utf-8")
    return re.findall(r"^```python\n(.*?)^```", text, flags=re.MULTILINE | re.DOTALL)


@pytest.mark.usefixtures("mujoco", "usd")
def test_the_examples_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    character(tmp_path)
    found = blocks("docs/python.md")
    assert len(found) > 5
    names: dict[str, Any] = {}
    for block in found:
        exec(compile(block, "docs/python.md", "exec"), names)


def run_commands(page: str, command: Path) -> int:
    """Runs the commands of the page, and returns how many there are."""
    text = (PROJECT / page).read_text(encoding="utf-8")
    shown = re.findall(r"^```sh\n(.*?)^```", text, flags=re.MULTILINE | re.DOTALL)
    lines = "".join(shown).splitlines()
    for line in lines:
        program, *arguments = line.split("  #")[0].split()
        assert program == "sscc", line
        done = subprocess.run([command, *arguments], capture_output=True, text=True)
        # 1: a mesh collides.
        assert done.returncode in (0, 1 if arguments[0] in ("check", "sweep") else 0), line + done.stderr
        assert done.stdout, line
    return len(lines)


def write_files(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The files that the first page names."""
    monkeypatch.syspath_prepend(str(PROJECT / "python/examples"))
    from mouth import mouth, mouth_glb  # type: ignore[import-not-found]

    character(folder)
    mouth_glb(folder).rename(folder / "face.glb")
    (folder / "bracket.obj").write_text(BRACKET)
    (folder / "scans").mkdir()
    vertices, faces, modes = mouth()
    weights = np.random.default_rng(3).uniform((0, 0, -0.3, -0.3), (0.72, 0.1, 0.3, 0.3), (12, 4))
    for number, of_scan in enumerate(weights):
        write_obj(folder / f"scans/{number}.obj", vertices + modes @ of_scan, faces)


def test_the_first_page_and_the_gallery_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    write_files(tmp_path, monkeypatch)
    assert run_commands("docs/index.md", command) == 11
    (block,) = blocks("docs/index.md")
    names: dict[str, Any] = {}
    exec(compile(block, "docs/index.md", "exec"), names)
    share = names["answers"].colliding.mean()
    assert 0.01 < share < 0.5 and f"{share:.1%} of the samples" in capsys.readouterr().out
    assert names["closest"].resolved
    assert run_commands("docs/gallery.md", command) == 5
    for picture in ("spring", "spring-polynomial", "bracket"):
        assert (tmp_path / f"{picture}.png").read_bytes().startswith(b"\x89PNG"), picture


def test_the_rolled_sheet_collides_at_its_end(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(PROJECT / "docs/site"))
    import sheet  # type: ignore[import-not-found]

    sheet.write(tmp_path)
    assert run_commands("docs/how-it-works.md", command) == 1
    assert (tmp_path / "sheet.html").stat().st_size > 100_000
