"""Tests of the interface on which scripts rely."""

from __future__ import annotations

import math
import pickle
from pathlib import Path

import numpy as np
import pytest

import sscc
from shapes import samples, torus, two_triangles


def test_the_first_example_gives_the_expected_answers() -> None:
    model = sscc.Model(*two_triangles())
    certs = model.certify()
    free = certs.check([0.5])
    assert not free.colliding and free.count == 0 and free.complete and free.root_certified
    assert free.pairs.shape == (0, 2) and free.pairs.dtype == np.uint32
    touching = certs.check(np.array([-1.0]))
    assert touching.colliding and touching.pairs.tolist() == [[0, 1]]
    assert not touching.root_certified and touching.triangle_tests > 0
    assert touching.norm == certs.norm([-1.0]) >= 1.0
    assert 0.8 <= certs.root_radius <= 1.0


def test_a_model_has_the_given_arrays(model: sscc.Model) -> None:
    vertices, faces, modes = torus(24, 12, 6)
    assert np.array_equal(model.vertices, vertices)
    assert np.array_equal(model.faces, faces) and model.faces.dtype == np.uint32
    assert np.array_equal(model.modes, modes) and model.modes.shape == (288, 3, 6)
    assert model.rank == 6 and model.metric == "displacement"
    assert np.allclose(model.metric_factor, np.linalg.norm(modes, axis=1).max(axis=0))
    assert (model.units, model.provenance, model.mode_names, model.stiffness) == ("", "", [], None)
    assert np.array_equal(model.default_q, np.zeros(6))
    q = samples(1, 6, 1.0)[0]
    assert np.allclose(model.positions(q), vertices + modes @ q, rtol=0, atol=1e-14)


def test_all_shapes_of_modes_give_the_same_model() -> None:
    vertices, faces, modes = torus(8, 5, 3)
    for given in (modes, modes.reshape(-1, 3), np.moveaxis(modes, 2, 0)):
        assert np.array_equal(sscc.Model(vertices, faces, given).modes, modes)
    one = sscc.Model(vertices, faces, modes[:, :, 0].ravel())
    assert np.array_equal(one.modes, modes[:, :, :1])


def test_metrics_change_norms_but_not_answers(model: sscc.Model) -> None:
    vertices, faces, modes = torus(24, 12, 6)
    qs = samples(40, 6, 0.4)
    expected = [answer.pairs.tolist() for answer in model.certify().check_many(qs)]
    assert any(expected) and not all(expected)
    weights = np.arange(1.0, 7.0)
    for metric in ("mass", "identity", weights, np.diag(weights) + 0.1):
        certs = model.certify(metric=metric)
        assert [answer.pairs.tolist() for answer in certs.check_many(qs)] == expected
        same = sscc.Model(vertices, faces, modes, metric=metric)
        assert np.array_equal(same.metric_factor, certs.metric_factor)
    assert np.isclose(model.certify(metric=weights).norm(qs[0]), math.sqrt(weights @ qs[0] ** 2))
    dense = np.diag(weights) + 0.1
    assert np.isclose(model.certify(metric=dense).norm(qs[0]), math.sqrt(qs[0] @ dense @ qs[0]))


def test_certificates_state_their_options(model: sscc.Model) -> None:
    center = np.full(6, 0.01)
    certs = model.certify(
        epsilon=0.3, center=center, scheme="paper", neighbours="include-one-vertex", weld=True, threads=1
    )
    assert certs.epsilon == 0.3 and np.array_equal(certs.center, center) and certs.norm(center) == 0
    assert certs.neighbours == "include-one-vertex" and certs.weld
    assert certs.pair_limit == 0 and certs.pairs == 6 and certs.exceptions.shape == (0, 2)
    assert model.certify(budget=64).pairs > model.certify(budget=0).pairs == 6
    paper, near, far = certs, *(model.certify(center=center, budget=4096, reach=reach) for reach in (1, 2))
    assert paper.global_radius == near.global_radius < far.global_radius <= 2 * near.global_radius
    assert certs.model is model


def test_contacts_at_rest_are_exceptions_or_ignored() -> None:
    vertices, faces, modes = two_triangles()
    vertices[3:, 2] = 0
    vertices[3:, 0] += 0.1
    model = sscc.Model(vertices, faces, modes)
    certs = model.certify()
    assert certs.rest_collisions == 1 and certs.exceptions.tolist() == [[0, 1]] and certs.clamp([1]) is None
    assert certs.check([0]).pairs.tolist() == [[0, 1]] and not certs.check([1]).colliding
    ignoring = model.certify(ignore_rest=True)
    assert ignoring.ignored.tolist() == [[0, 1]] and not ignoring.check([0]).colliding
    strict = model.certify(max_exceptions=0)
    assert strict.root_radius == 0 and len(strict.exceptions) == 0


def test_a_limit_stops_the_search(certs: sscc.Certificates) -> None:
    q = next(q for q in samples(100, 6, 0.6) if certs.check(q).count > 3)
    whole, some = certs.check(q), certs.check(q, limit=2)
    assert some.count == 2 and not some.complete and whole.complete
    assert {tuple(pair) for pair in some.pairs} <= {tuple(pair) for pair in whole.pairs}
    batch = certs.check_many([q, q * 0], limit=2)
    assert batch.count.tolist() == [2, 0] and batch.complete.tolist() == [False, True]


def test_batches_equal_single_answers(certs: sscc.Certificates) -> None:
    qs = samples(200, 6, 0.3)
    batch = certs.check_many(qs, threads=2)
    assert len(batch) == 200 and batch == certs.check_many(qs, threads=1)
    for i, (q, answer) in enumerate(zip(qs, batch, strict=True)):
        assert answer == certs.check(q) and answer.norm == batch.norm[i]
        rows = slice(batch.offsets[i], batch.offsets[i + 1])
        assert np.array_equal(batch.pairs[rows], answer.pairs)
    assert batch.colliding.dtype == bool and 0 < batch.colliding.sum() < 200
    assert np.array_equal(batch.count, np.diff(batch.offsets))
    assert batch.root_certified.any() and batch.complete.all()
    assert batch.opened.sum() > 0 and batch.triangle_tests.sum() > 0
    assert batch[-1] == batch[199]
    with pytest.raises(IndexError, match="200 answers"):
        batch[200]
    empty = certs.check_many(np.zeros((0, 6)))
    assert len(empty) == 0 and empty.pairs.shape == (0, 2) and empty.offsets.tolist() == [0]


def test_continuous_queries_return_times() -> None:
    certs = sscc.Model(*two_triangles()).certify()
    impacts = certs.continuous([0.0], [-2.0])
    assert impacts.colliding and impacts.count == 1 and impacts.pairs.tolist() == [[0, 1]]
    assert impacts.times.shape == (1,) and impacts.time_of_impact == impacts.times[0]
    assert 0.5 - 1e-9 <= impacts.times[0] <= 0.5
    free = certs.continuous([0.0], [0.5])
    assert not free.colliding and free.time_of_impact is None and free.root_certified and free.complete
    assert free.norm == certs.norm([0.5]) and free.times.shape == (0,)


def test_safe_scales_and_clamped_q_are_free(certs: sscc.Certificates) -> None:
    for q in samples(10, 6, 1.0):
        scale = certs.safe_scale(q)
        assert scale >= certs.root_radius / certs.norm(q) * 0.999
        if math.isfinite(scale):
            assert not certs.continuous(q * 0, q * scale).colliding
        inside = certs.clamp(q)
        assert inside is not None and certs.norm(inside) < certs.root_radius
        assert np.allclose(inside / np.linalg.norm(inside), q / np.linalg.norm(q))
    small = np.full(6, 1e-9)
    unchanged = certs.clamp(small)
    assert unchanged is not None and np.array_equal(unchanged, small)
    assert certs.safe_scale(np.zeros(6)) == math.inf


def test_kinetic_queries_give_the_same_answers(certs: sscc.Certificates) -> None:
    kinetic = certs.kinetic()
    start, end = samples(2, 6, 0.5)
    for share in np.linspace(0, 1, 200):
        q = start + share * (end - start)
        assert np.array_equal(kinetic.check(q).pairs, certs.check(q).pairs)


def test_the_hierarchy_covers_all_triangles(certs: sscc.Certificates) -> None:
    tree = certs.hierarchy
    assert len(tree) == certs.nodes == len(tree.parent) and tree.parent[0] == -1
    assert sorted(tree.order) == list(range(576)) and tree.count[0] == 576
    child = np.arange(1, len(tree))
    assert np.array_equal(tree.level[child], tree.level[tree.parent[child]] + 1)
    assert (tree.radius[child] >= tree.radius[tree.parent[child]]).all()
    assert certs.radius(0) == certs.root_radius == tree.radius[0]
    assert certs.radius(np.int64(5)) == tree.radius[5]


def test_files_round_trip(tmp_path: Path, model: sscc.Model, certs: sscc.Certificates) -> None:
    model.save(tmp_path / "a.model.safetensors")
    certs.save(str(tmp_path / "a.sscc.safetensors"))
    again = sscc.Model.load(str(tmp_path / "a.model.safetensors"))
    assert np.array_equal(again.modes, model.modes) and np.array_equal(again.vertices, model.vertices)
    read = sscc.Certificates.load(tmp_path / "a.sscc.safetensors", again)
    assert read.digest == certs.digest and len(read.digest) == 64
    qs = samples(50, 6, 0.3)
    assert read.check_many(qs) == certs.check_many(qs)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.model.safetensors", "a.sscc.safetensors"]


def test_meshes_with_modes_are_loaded(tmp_path: Path) -> None:
    (tmp_path / "two.obj").write_text(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nf 1 2 3\nf 4 5 6\n"
    )
    vertices, faces, modes = two_triangles()
    np.save(tmp_path / "two.npy", modes.reshape(-1, 1))
    model = sscc.Model.load(tmp_path / "two.obj", tmp_path / "two.npy")
    assert np.array_equal(model.vertices, vertices) and np.array_equal(model.modes, modes)
    assert model.provenance == "mesh two.obj, modes two.npy"


def test_principal_components_have_standard_deviations(tmp_path: Path) -> None:
    vertices, faces, modes = two_triangles()
    components = np.zeros((2, 18))
    components[0, 3] = components[1, 7] = 1
    path = tmp_path / "a.npz"
    np.savez(path, mean=vertices, components=components, faces=faces, explained_variance=np.array([4.0, 0.25]))
    model = sscc.Model.load(path)
    for same in (model, pickle.loads(pickle.dumps(model))):
        deviations = same.deviations
        assert deviations is not None and not deviations.flags.writeable
        assert deviations.dtype == float and deviations.tolist() == [2, 0.5]
    assert sscc.Model(vertices, faces, modes).deviations is None


def test_result_arrays_are_read_only(certs: sscc.Certificates) -> None:
    answer = certs.check(np.full(6, 2.0))
    assert answer.colliding and answer.pairs is answer.pairs
    with pytest.raises(ValueError, match="read-only"):
        answer.pairs[0, 0] = 1
    batch = certs.check_many(np.full((3, 6), 2.0))
    with pytest.raises(ValueError, match="read-only"):
        batch.norm[0] = 1


def test_results_have_no_truth_value(certs: sscc.Certificates) -> None:
    for result in (certs.check(np.zeros(6)), certs.continuous(np.zeros(6), np.zeros(6))):
        with pytest.raises(TypeError, match=r"use \.colliding"):
            bool(result)
