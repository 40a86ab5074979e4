"""The examples of docs/python.md run, and so do those of the first pages of the site."""

from __future__ import annotations

import json
import re
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sscc
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


def run(arguments: list[Any]) -> None:
    """Runs the command, which may find a collision."""
    done = subprocess.run(arguments, capture_output=True, text=True)
    assert done.returncode in (0, 1 if arguments[1] in ("check", "sweep") else 0), f"{arguments}: {done.stderr}"
    assert done.stdout, arguments


def run_commands(page: str, command: Path, is_chosen: Callable[[str], bool] = lambda _: True) -> int:
    """Runs the chosen commands of the page, and returns their number."""
    text = (PROJECT / page).read_text(encoding="utf-8")
    shown = re.findall(r"^```sh\n(.*?)^```", text, flags=re.MULTILINE | re.DOTALL)
    lines = [line for line in "".join(shown).splitlines() if is_chosen(line)]
    for line in lines:
        # Output that a line writes to a file is not kept.
        program, *arguments = line.split("  #")[0].split(" > ")[0].split()
        assert program == "sscc", line
        run([command, *arguments])
    return len(lines)


def write_files(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Writes the files that the first page names."""
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
    assert names["repaired"].resolved
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

#: Parts of lines of docs/command.md that Rust tests run: a model in statics.rs, an audit in clearance.rs, proofs in proof.rs.
RUN_ELSEWHERE = ("bracket.model", "sscc audit face", "spring.proof")

#: Lines of docs/command.md whose q are for a model of three modes.
OF_THREE_MODES = ("face.model.safetensors --trajectory", "near.sscc")


def write_stl(path: Path, corners: list[list[float]]) -> None:
    """Writes a tetrahedron as STL."""
    a, b, c, d = (" ".join(map(str, corner)) for corner in corners)
    facets = "".join(
        "facet normal 0 0 0\nouter loop\n" + "".join(f"vertex {v}\n" for v in face) + "endloop\nendfacet\n"
        for face in ((a, c, b), (a, b, d), (b, c, d), (a, d, c))
    )
    path.write_text(f"solid part\n{facets}endsolid part\n")


def write_guide_files(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Writes the files that the guide of the command names, except those of VTK."""
    monkeypatch.syspath_prepend(str(PROJECT / "python/examples"))
    import mouth as example

    monkeypatch.setattr(example, "NAMES", ["jawOpen", "bite", "smile", "purse"])
    example.mouth_glb(folder).rename(folder / "head.glb")
    scene = json.loads(character(folder).read_text())
    scene["nodes"].append({"name": "button", "mesh": 1, "translation": [0, 0, 3]})
    (folder / "character.glb").write_text(json.dumps(scene))
    vertices, faces, modes = example.mouth()
    np.savez(folder / "body.npz", mean=vertices, components=np.moveaxis(modes, 2, 0), faces=faces)
    sscc.Model(vertices, faces, modes[:, :, :3]).save(folder / "face.model.safetensors")
    np.save(folder / "q.npy", [[0.1, 0, 0, 0], [0.9, 0.2, 0, 0]])
    for name, height in (("a", 0.0), ("cloth", 0.0), ("shirt", 0.0), ("body", 0.02), ("part", 0.0), ("face", 0.0)):
        write_obj(folder / f"{name}.obj", vertices + (0, 0, height), faces)
    motion = np.array([vertices + modes @ (0, 0, weight, 0) for weight in (0.0, 0.1, 0.2)])
    for name in ("frames", "s", "b"):
        np.save(folder / f"{name}.npy", motion)
    for target in ("cache", "meshes"):
        (folder / target).mkdir()
        for number, frame in enumerate(motion):
            write_obj(folder / target / f"{number}.obj", frame, faces)
    write_stl(folder / "c.stl", [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    write_stl(folder / "part.stl", [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    write_stl(folder / "other.stl", [[0.1, 0.1, 0.1], [2, 0, 0], [0, 2, 0], [0, 0, 2]])


def test_the_guide_of_the_command_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    write_guide_files(tmp_path, monkeypatch)
    run([command, "check", "a.obj", "--pose", "b.ply"])
    run([command, "check", "a.obj", "--pose", "result.vtu"])
    run([command, "check", "cloth.obj", "--frames", "frames.npy", "--frames-out", "result.pvd"])
    run([command, "certify", "face.model.safetensors", "-o", "face.sscc.safetensors"])

    def is_run_elsewhere(line: str) -> bool:
        return any(text in line for text in RUN_ELSEWHERE)

    def is_of_three_modes(line: str) -> bool:
        return any(text in line for text in OF_THREE_MODES) and not is_run_elsewhere(line)

    others = run_commands(
        "docs/command.md", command, lambda line: not is_run_elsewhere(line) and not is_of_three_modes(line)
    )
    assert others > 30
    np.save(tmp_path / "q.npy", [[0.1, 0, 0], [0.9, 0.2, 0]])
    assert run_commands("docs/command.md", command, is_of_three_modes) == 3
