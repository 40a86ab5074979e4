"""Answers of the package equal those of the command."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sscc
from shapes import samples, torus, write_obj


def lines(command: Path, *arguments: object) -> list[dict[str, Any]]:
    done = subprocess.run([command, *map(str, arguments), "--json"], capture_output=True, text=True)
    assert done.returncode in (0, 1), done.stderr
    return [json.loads(line) for line in done.stdout.splitlines()]


def test_certificates_and_answers_are_the_same(
    tmp_path: Path, command: Path, model: sscc.Model, certs: sscc.Certificates
) -> None:
    file = tmp_path / "a.model.safetensors"
    ours, theirs = tmp_path / "o.sscc.safetensors", tmp_path / "t.sscc.safetensors"
    model.save(file)
    certs.save(ours)
    (result,) = lines(command, "certify", file, "-o", theirs)
    assert ours.read_bytes() == theirs.read_bytes()
    assert (result["root_radius"], result["global_radius"]) == (certs.root_radius, certs.global_radius)
    assert (result["nodes"], result["pairs"]) == (certs.nodes, certs.pairs)

    qs = samples(100, 6, 0.4)
    np.save(tmp_path / "q.npy", qs)
    arguments = ("check", file, "--certificates", theirs, "--trajectory", tmp_path / "q.npy")
    keys = ("norm", "colliding", "count", "complete", "root_certified", "opened", "box_tests", "triangle_tests")
    for q, line in zip(qs, lines(command, *arguments), strict=True):
        answer = certs.check(q)
        assert [line[key] for key in keys] == [getattr(answer, key) for key in keys]
        assert line["pairs"] == answer.pairs.tolist()
    for (q0, q1), line in zip(zip(qs, qs[1:]), lines(command, *arguments, "--continuous"), strict=True):
        impacts = certs.continuous(q0, q1)
        assert [line[key] for key in keys] == [getattr(impacts, key) for key in keys]
        assert (line["pairs"], line["times"]) == (impacts.pairs.tolist(), impacts.times.tolist())


@pytest.mark.parametrize(
    ("flags", "options"),
    [
        (["--metric", "mass", "--epsilon", "0.3"], {"metric": "mass", "epsilon": 0.3}),
        (["--scheme", "paper"], {"scheme": "paper"}),
        (["--center", "0.1,0,0,0,0,0", "--budget", "64"], {"center": [0.1, 0, 0, 0, 0, 0], "budget": 64}),
        (
            ["--neighbours", "include-one-vertex", "--weld=on"],
            {"neighbours": "include-one-vertex", "weld": True},
        ),
        (["--reach", "1.5", "--budget", "512"], {"reach": 1.5, "budget": 512}),
        (["--ignore-rest", "--max-exceptions", "7"], {"ignore_rest": True, "max_exceptions": 7}),
    ],
)
def test_options_have_the_same_meaning(
    tmp_path: Path, command: Path, model: sscc.Model, flags: list[str], options: dict[str, Any]
) -> None:
    file = tmp_path / "a.model.safetensors"
    ours, theirs = tmp_path / "o.sscc.safetensors", tmp_path / "t.sscc.safetensors"
    model.save(file)
    model.certify(**options).save(ours)
    lines(command, "certify", file, "-o", theirs, *flags)
    assert ours.read_bytes() == theirs.read_bytes()


def test_modes_in_files_and_in_memory_are_the_same(tmp_path: Path, command: Path) -> None:
    vertices, faces, modes = torus(16, 8, 3)
    write_obj(tmp_path / "a.obj", vertices, faces)
    for number, shape in enumerate((modes, modes.reshape(-1, 3), np.moveaxis(modes, 2, 0))):
        path = tmp_path / f"{number}.npy"
        np.save(path, shape)
        output = tmp_path / "a.sscc.safetensors"
        (result,) = lines(command, "certify", tmp_path / "a.obj", "--modes", path, "-o", output)
        certs = sscc.Model(vertices, faces, shape).certify()
        assert result["root_radius"] == certs.root_radius
        read = sscc.Certificates.load(output, sscc.Model.load(tmp_path / "a.obj", path))
        assert read.digest == certs.digest
