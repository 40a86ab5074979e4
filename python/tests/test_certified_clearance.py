"""Certificates with a clearance."""

from pathlib import Path

import numpy as np
import pytest

import sscc


def test_near_pairs_are_those_of_a_detector(model: sscc.Model, tmp_path: Path) -> None:
    size = float(np.ptp(model.positions(np.zeros(6)), axis=0).max())
    clearance = 0.02 * size
    near = model.certify(clearance=clearance, rings=4)
    assert (near.clearance, near.rings) == (clearance, 4)
    assert near.local_certificates == 0
    near.save(tmp_path / "near.sscc.safetensors")
    again = sscc.Certificates.load(tmp_path / "near.sscc.safetensors", model)
    assert (again.clearance, again.rings, again.root_radius) == (clearance, 4, near.root_radius)
    detector, plain = sscc.Detector(model.faces), model.certify(budget=0)
    rng = np.random.default_rng(3)
    found = 0
    for turn in range(40):
        q = rng.normal(size=6)
        q *= (0.3 + 0.2 * turn) * near.root_radius / near.norm(q)
        for share, rings in [(1.0, 4), (0.5, 4), (1.0, 6), (1.0, 2), (1.5, 4)]:
            pairs, distances = near.within(q, share * clearance, rings=rings)
            expected, lengths = detector.within(model.positions(q), share * clearance, rings=rings)
            np.testing.assert_array_equal(pairs, expected)
            np.testing.assert_array_equal(distances, lengths)
            found += len(pairs)
        # Collisions are found without the certificates.
        assert near.check(q).pairs.tolist() == plain.check(q).pairs.tolist()
    assert near.root_radius > 0 and found > 0
    assert near.clamp(q) is None


def test_unusable_clearances_are_refused(model: sscc.Model, certs: sscc.Certificates) -> None:
    assert (certs.clearance, certs.rings) == (None, None)
    for bad in (0.0, -1.0, np.inf, np.nan):
        with pytest.raises(ValueError, match=r"^clearance is .*: it must be positive and finite$"):
            model.certify(clearance=bad)
        with pytest.raises(ValueError, match=r"^clearance is .*: it must be positive and finite$"):
            certs.within(np.zeros(6), bad)
    with pytest.raises(ValueError, match=r"^rings is set without clearance"):
        model.certify(rings=2)
    with pytest.raises(ValueError, match=r"^q "):
        certs.within(np.zeros(5), 0.1)
