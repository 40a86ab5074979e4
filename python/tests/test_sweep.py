"""Sweeps of the weights of single modes."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

import sscc
from shapes import two_triangles


def test_a_sweep_ends_at_the_first_contact(certs: sscc.Certificates) -> None:
    sweeps = certs.sweep((-3.0, 2.0), modes=[1, 0], threads=1)
    assert [(s.mode, s.name, s.start, s.end) for s in sweeps] == [
        (1, "1", 0.0, 2.0), (1, "1", 0.0, -3.0), (0, "0", 0.0, 2.0), (0, "0", 0.0, -3.0),
    ]  # fmt: skip
    assert any(s.first_hit is not None for s in sweeps)
    for sweep in sweeps:
        assert sweep.first_free is not None and sweep.pairs.dtype == np.uint32
        weights = np.zeros((2000, 6))
        weights[:, sweep.mode] = np.linspace(0, sweep.first_free, 2000)
        assert not certs.check_many(weights).colliding.any()
        if sweep.first_hit is None:
            assert sweep.first_free == sweep.end and sweep.note is None
        elif sweep.note is None:
            assert abs(sweep.first_hit - sweep.first_free) <= 3e-9
            weights[0, sweep.mode] = sweep.first_hit
            assert np.array_equal(certs.check(weights[0]).pairs, sweep.pairs) and len(sweep.pairs)


def test_sweeps_use_the_given_starts_and_ranges() -> None:
    certs = sscc.Model(*two_triangles()).certify()
    (hit,) = [s for s in certs.sweep([[-4, 4]], q=[0.5]) if s.first_hit is not None]
    assert hit.start == 0.5 and hit.first_hit == -1.0 and hit.pairs.tolist() == [[0, 1]]
    start = certs.sweep(q=[-1.0])[0]
    assert start.first_free is None and start.first_hit == -1.0
    assert start.note is not None and start.note.startswith("the shape collides at the start")
    with pytest.raises(ValueError, match="is empty"):
        certs.sweep((1, 1))
    with pytest.raises(ValueError, match=r"range has shape \[3\]"):
        certs.sweep([1, 2, 3])
    with pytest.raises(ValueError, match="q has 2 entries"):
        certs.sweep(q=[1, 2])
    with pytest.raises(ValueError, match="the modes of this model have no names"):
        certs.sweep(modes=["smile"])


def test_intervals_are_those_of_samples(certs: sscc.Certificates) -> None:
    found = certs.intervals((-3.0, 2.0), samples=21, modes=[1, 0], threads=1)
    assert [(f.mode, f.name, f.start, f.end) for f in found] == [(1, "1", -3.0, 2.0), (0, "0", -3.0, 2.0)]
    assert any(f.intervals for f in found)
    for one in found:
        assert not one.samples.flags.writeable and one.samples.shape == (21, 3)
        weights = np.zeros((2000, 6))
        weights[:, one.mode] = np.linspace(-3.0, 2.0, 2000)
        inside = np.zeros(2000, dtype=bool)
        for i in one.intervals:
            low = -np.inf if i.free_until is None else i.free_until
            high = np.inf if i.free_from is None else i.free_from
            inside |= (weights[:, one.mode] > low) & (weights[:, one.mode] < high)
        assert not certs.check_many(weights).colliding[~inside].any()
        weights[:21, one.mode] = one.samples[:, 0]
        assert np.array_equal(certs.check_many(weights[:21]).count, one.samples[:, 1])
    with pytest.raises(ValueError, match="samples is 1"):
        certs.intervals(samples=1)


def test_principal_components_go_to_three_standard_deviations() -> None:
    vertices, faces, modes = two_triangles()
    shapes = [vertices + modes[:, :, 0] * offset for offset in (0.9, 1.0, 1.1, 1.2)]
    certs = sscc.modes.pca(shapes, faces, 1).certify()
    assert [sweep.end for sweep in certs.sweep()] == [3.0, -3.0]
    again = pickle.loads(pickle.dumps(certs))
    assert [sweep.end for sweep in again.sweep()] == [3.0, -3.0]
