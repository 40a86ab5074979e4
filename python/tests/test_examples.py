"""The examples run and give the expected results."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sscc

FOLDER = Path(__file__).parents[1] / "examples"


@pytest.fixture(autouse=True)
def folder(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(FOLDER))


def example(name: str) -> Any:
    return importlib.import_module(name)


def test_samples_of_a_shape_model_and_their_safe_steps(capsys: pytest.CaptureFixture[str]) -> None:
    colliding, steps, repaired = example("pca_shapes").main()
    assert 20 < colliding.sum() < 480
    # Every colliding sample is beyond its safe step.
    assert (steps[colliding] <= 1).all() and steps.min() > 0
    assert not repaired.any()
    assert f"{colliding.sum()} of 500 samples intersect themselves" in capsys.readouterr().out


def test_a_performance_of_blendshapes_from_a_glb() -> None:
    colliding, begins = example("performance").main()
    assert 0 < colliding.sum() < len(colliding)
    # Each sequence of colliding frames begins with a contact between two frames.
    starts = np.flatnonzero(~colliding[:-1] & colliding[1:])
    assert len(starts) > 0 and set(starts) <= set(begins)
    assert all(frame <= time <= frame + 1 for frame, time in begins.items())


@pytest.mark.parametrize("file, mesh", [("MorphStressTest.gltf", None), ("RobotExpressive.glb", "Head")])
def test_a_performance_of_real_files(models: Path, file: str, mesh: str | None) -> None:
    colliding, begins = example("performance").main(str(models / "morph" / file), mesh)
    assert len(colliding) == 240
    assert set(np.flatnonzero(~colliding[:-1] & colliding[1:])) <= set(begins)


def test_a_hundred_thousand_configurations() -> None:
    many = example("many")
    answers = many.main()
    assert len(answers) == 100_000 and 0 < answers.colliding.sum() < 100_000
    certificates = sscc.Model(*example("mouth").mouth()).certify()
    Q = np.random.default_rng(2).normal(scale=0.5, size=(100_000, 4))
    for row in range(0, 100_000, 9973):
        assert answers[row] == certificates.check(Q[row])


def test_frames_of_a_deforming_mesh() -> None:
    batch, begins, met = example("deforming").main()
    assert 0 < batch.colliding.sum() < len(batch) and 0 < met.sum() < len(met)
    starts = np.flatnonzero(~batch.colliding[:-1] & batch.colliding[1:])
    assert len(starts) > 0 and set(starts) <= set(begins)


@pytest.mark.usefixtures("mujoco")
def test_a_soft_bar_in_mujoco() -> None:
    colliding = example("mujoco_bar").main()
    assert 0 < colliding.sum() < len(colliding) and not colliding[:100].any()


def test_poses_of_simplicits() -> None:
    colliding = example("simplicits").main()
    assert 0 < colliding.sum() < len(colliding)


def test_coordinates_of_a_reduced_model_in_sofa() -> None:
    sweeps = example("sofa_modes").main()
    assert len(sweeps) == 6 and any(sweep.first_hit is not None for sweep in sweeps)


@pytest.mark.filterwarnings("default")
def test_a_cluster() -> None:
    pytest.importorskip("distributed", reason="dask.distributed is not installed")
    from distributed import Client, LocalCluster

    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        library, large, answers = example("cluster").main(client)
    assert library.failures == {} and len(library.certificates) == 3
    assert large.root_radius == library.certificates["width 1.0"].root_radius
    assert len(answers) == 20_000 and answers.colliding.any()


def test_every_example_is_tested() -> None:
    names = {path.stem for path in FOLDER.glob("*.py")} - {"mouth"}
    tested = Path(__file__).read_text()
    assert names and all(f'example("{name}")' in tested for name in names)
    assert str(FOLDER) in sys.path
