"""Modes of bodies and of samples."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import sscc
from shapes import torus, write_obj


Surface = tuple[NDArray[np.float64], NDArray[np.int64]]


@pytest.fixture(scope="module")
def surface() -> Surface:
    vertices, faces, _ = torus(24, 12, 1)
    return vertices, faces


def test_linear_modes(surface: Surface) -> None:
    model = sscc.modes.linear(surface, 8, resolution=14)
    assert model.rank == 8 and model.metric == "energy"
    stiffness = model.stiffness
    assert stiffness is not None
    assert np.allclose(stiffness, np.diag(np.diag(stiffness)))
    # The metric is M = Lambda / 2.
    assert np.allclose(model.metric_factor**2 * 2, np.diag(stiffness))
    assert "8" not in model.units and model.provenance.startswith("mesh in memory, linear modes, ")
    assert not model.certify().check(np.zeros(8)).colliding


def test_fixed_vertices_do_not_move(surface: Surface) -> None:
    vertices = surface[0]
    box = sscc.modes.linear(surface, 3, resolution=14, fix_box=[[-2, -2, -2], [-1, 2, 2]])
    moved = np.abs(box.modes).max(axis=(1, 2))
    assert moved[vertices[:, 0] <= -1].max() < 1e-12 < 1e-3 < moved.max()
    held = np.flatnonzero(vertices[:, 0] <= -1)
    some = sscc.modes.linear(surface, 3, resolution=14, fix=held)
    assert np.abs(some.modes[held]).max() < 1e-12


def test_nonlinear_and_polynomial_modes(surface: Surface) -> None:
    nonlinear = sscc.modes.nonlinear(surface, 10, resolution=10, youngs=1e4)
    assert nonlinear.rank == 10 and nonlinear.stiffness is not None
    plain = sscc.modes.polynomial(surface)
    assert plain.rank == 24 and plain.metric == "displacement" and plain.stiffness is None
    solid = sscc.modes.polynomial(surface, solid=True, resolution=10)
    assert solid.rank == 24 and solid.metric == "energy" and solid.stiffness is not None


def test_models_of_files_equal_those_of_the_command(tmp_path: Path, command: Path, surface: Surface) -> None:
    vertices, faces, _ = torus(24, 12, 1)
    mesh, theirs, ours = (tmp_path / name for name in ("a.obj", "t.model.safetensors", "o.model.safetensors"))
    write_obj(mesh, vertices, faces)
    for kind in ("linear", "nonlinear", "polynomial"):
        options = [] if kind == "polynomial" else ["--rank", "6", "--resolution", "10"]
        arguments = ["modes", mesh, "-o", theirs, "--kind", kind, "--json", *options]
        done = subprocess.run([command, *arguments], capture_output=True)
        assert done.returncode == 0 and json.loads(done.stdout)["triangles"] == 576
        make = getattr(sscc.modes, kind)
        model = make(mesh) if kind == "polynomial" else make(mesh, 6, resolution=10)
        model.save(ours)
        assert ours.read_bytes() == theirs.read_bytes()


def test_principal_components_span_the_shapes() -> None:
    vertices, faces, modes = torus(12, 8, 4)
    weights = np.random.default_rng(5).normal(size=(20, 4))
    shapes = vertices + np.einsum("var,nr->nva", modes, weights)
    for given in (shapes, shapes.reshape(20, -1), np.asfortranarray(shapes)):
        model = sscc.modes.pca(given, faces, 4)
        assert model.rank == 4 and np.allclose(model.vertices, shapes.mean(axis=0))
        matrix = model.modes.reshape(-1, 4)
        rest = (shapes - model.vertices).reshape(20, -1).T
        q = np.linalg.lstsq(matrix, rest, rcond=None)[0]
        assert np.abs(matrix @ q - rest).max() < 1e-12
        assert np.allclose(q.std(axis=1, ddof=1), 1)
    assert model.provenance == "mean and principal components of 20 shapes in memory"
    assert model.deviations is not None and model.deviations.tolist() == [1] * 4
    assert sscc.modes.pca(shapes, faces).rank <= 4


def test_shapes_in_a_folder_equal_shapes_in_memory(tmp_path: Path) -> None:
    vertices, faces, modes = torus(8, 5, 2)
    shapes = [vertices + modes @ q for q in np.random.default_rng(5).normal(size=(6, 2))]
    for number, shape in enumerate(shapes):
        write_obj(tmp_path / f"{number}.obj", shape, faces)
    files, memory = sscc.modes.pca(tmp_path, rank=2), sscc.modes.pca(np.array(shapes), faces, 2)
    assert np.array_equal(files.modes, memory.modes) and np.array_equal(files.vertices, memory.vertices)


def test_errors_name_the_argument_or_the_file(tmp_path: Path, surface: Surface) -> None:
    vertices, faces, _ = torus(12, 8, 1)
    solid = tmp_path / "s.mesh"
    content = "MeshVersionFormatted 1\nDimension 3\nVertices 4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\nTetrahedra 1\n1 2 3 4 0\n"
    solid.write_text(content)
    text: Any = "x"
    not_a_pair: Any = vertices
    one_corner = r"^fix_box has shape \[1, 3\]: \(2, 3\) was expected, two corners of a box$"
    three_corners = r"^fix_box has shape \[3, 2\]: \(2, 3\) was expected"
    no_corners = [(np.nan, r"^fix_box\[0\]\[1\] is NaN: every entry"), (-np.inf, r"^fix_box\[0\]\[1\] is -inf: every")]
    cases: list[tuple[Callable[[], object], type[Exception], str]] = [
        (lambda: sscc.modes.linear((vertices, faces[1:]), 3), ValueError, "^source: "),
        (lambda: sscc.modes.linear(not_a_pair, 3), TypeError, "^source is a ndarray: the name of a file or"),
        (lambda: sscc.modes.linear(tmp_path / "a.obj", 3), FileNotFoundError, r"a\.obj: not found$"),
        (lambda: sscc.modes.linear((vertices, faces), 0), ValueError, "^rank is 0: a whole number from 1 to 500"),
        (lambda: sscc.modes.linear((vertices, faces), 3, fix=[96]), ValueError, "^source: fix: there is no vertex 96"),
        (lambda: sscc.modes.linear((vertices, faces), 3, fix=[]), ValueError, "fix: it selects no vertex: name vertices"),
        (lambda: sscc.modes.linear((vertices, faces), 3, fix=[[1]]), ValueError, r"^fix has shape \[1, 1\]"),
        (lambda: sscc.modes.linear((vertices, faces), 3, fix=[-1]), ValueError, r"^fix\[0\] is -1"),
        (lambda: sscc.modes.linear((vertices, faces), 3, fix_box=[[0, 0, 0]]), ValueError, one_corner),
        (lambda: sscc.modes.linear((vertices, faces), 3, fix_box=np.zeros((3, 2))), ValueError, three_corners),
        (lambda: sscc.modes.linear((vertices, faces), 3, youngs=-1), ValueError, "^source: "),
        (lambda: sscc.modes.linear((vertices, faces), 3, poisson=text), TypeError, "^poisson is a str"),
        (lambda: sscc.modes.nonlinear((vertices, faces), 3, threads=-1), ValueError, "^threads is -1"),
        (lambda: sscc.modes.polynomial((vertices, faces), resolution=0), ValueError, "^resolution is 0"),
        (lambda: sscc.modes.linear(solid, 3, resolution=4), ValueError, r"s\.mesh: resolution is for surfaces: "),
        (lambda: sscc.modes.pca(vertices, faces), ValueError, r"^shapes has shape \[96, 3\]: \(n, V, 3\)"),
        (lambda: sscc.modes.pca(vertices[None], faces), ValueError, "^shapes: "),
        (lambda: sscc.modes.pca(vertices[None]), TypeError, "^faces is missing"),
        (lambda: sscc.modes.pca(np.zeros((0, 4, 3)), faces), ValueError, "^shapes is empty"),
        (lambda: sscc.modes.pca(np.full((3, 96, 3), np.nan), faces), ValueError, "^shapes: "),
        (lambda: sscc.modes.pca(np.empty((2**40, 0, 3)), faces), ValueError, r"^shapes has shape \[1099511627776, 0, 3\]"),
        (lambda: sscc.modes.pca(np.empty((2**40, 0)), faces), ValueError, r"^shapes has shape \[1099511627776, 0\]"),
        (lambda: sscc.modes.pca(tmp_path / "none"), FileNotFoundError, "not found$"),
        (lambda: sscc.modes.pca(tmp_path, faces), ValueError, "^faces: the meshes of a folder have their own"),
    ]
    for call, error, message in cases:
        with pytest.raises(error, match=message):
            call()
    for bound, message in no_corners:
        with pytest.raises(ValueError, match=message):
            sscc.modes.linear((vertices, faces), 3, fix_box=[[-2.0, bound, -2.0], [2.0, 2.0, 2.0]])


def test_loads_and_displacements_give_q(surface: Surface) -> None:
    model = sscc.modes.linear(surface, 8, resolution=14, fix=[0, 1, 2, 3])
    forces = np.zeros((len(surface[0]), 3))
    forces[100] = [0, 0, -1e-3]
    q = model.static(forces)
    assert model.stiffness is not None
    assert np.allclose(model.stiffness @ q, np.einsum("vcr,vc->r", model.modes, forces))
    heavy = model.static(0 * forces, gravity=(0, 0, -9.81))
    assert np.abs(heavy).max() > 0
    fitted, residual = model.fit(model.positions(q))
    assert np.allclose(fitted, q, atol=1e-9 * np.abs(q).max()) and residual < 1e-9
    other = model.vertices + np.random.default_rng(1).normal(size=forces.shape)
    best, left = model.fit(other)
    U = model.modes.reshape(-1, 8)
    expected = np.linalg.lstsq(U, (other - model.vertices).ravel(), rcond=None)[0]
    assert np.allclose(best, expected, rtol=1e-9) and 0.5 < left < 1
    for bad, message in [(forces[1:], "forces has"), (forces[:, :2], "forces has shape")]:
        with pytest.raises(ValueError, match=message):
            model.static(bad)
    with pytest.raises(ValueError, match="gravity has 2 numbers"):
        model.static(forces, gravity=[0, 1])
    with pytest.raises(ValueError, match="the model has no stiffness"):
        sscc.Model(*surface, model.modes).static(forces)
    with pytest.raises(ValueError):
        model.fit(forces * np.nan)
