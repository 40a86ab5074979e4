"""Free configurations near colliding ones, and free samples."""

from __future__ import annotations

import math
import pickle
from typing import Any

import numpy as np
import pytest

import sscc
from shapes import samples, two_triangles


def test_resolved_configurations_are_free(certs: sscc.Certificates) -> None:
    qs = samples(60, 6, 0.4)
    colliding = qs[certs.check_many(qs).colliding]
    assert len(colliding) > 5
    for q in colliding[:10]:
        found = certs.resolve(q)
        assert isinstance(found, sscc.Resolved) and found.resolved and found.q is not None
        assert not certs.check(found.q).colliding
        assert 0 < found.change <= found.safe_scale_change
        change = float(np.linalg.norm(certs.metric_factor * (found.q - q)))
        assert math.isclose(found.change, change, rel_tol=1e-9)
        again = pickle.loads(pickle.dumps(found))
        assert np.array_equal(again.q, found.q) and again.change == found.change
    free = qs[~certs.check_many(qs).colliding][0]
    found = certs.resolve(free)
    assert found.q is not None and np.array_equal(found.q, free)
    assert (found.change, found.safe_scale_change) == (0, 0)


def test_samples_state_their_acceptance(certs: sscc.Certificates) -> None:
    draws = samples(60, 6, 0.4)
    is_free = ~certs.check_many(draws).colliding
    shares: list[float] = []
    resolved = certs.free_samples(draws, threads=2, progress=shares.append)
    assert isinstance(resolved, sscc.FreeSamples) and shares[-1] == 1
    assert (len(resolved.q), resolved.drawn, resolved.free) == (60, 60, is_free.sum())
    assert resolved.acceptance == is_free.mean()
    assert np.array_equal(resolved.changes == 0, is_free)
    assert not certs.check_many(resolved.q).colliding.any()
    first = certs.resolve(draws[~is_free][0]).q
    assert first is not None and np.array_equal(resolved.q[~is_free][0], first)
    rejected = certs.free_samples(draws, resolve=False)
    assert np.array_equal(rejected.q, draws[is_free]) and np.array_equal(rejected.draws, np.flatnonzero(is_free))
    nothing = certs.free_samples(np.zeros((0, 6)))
    assert nothing.q.shape == (0, 6) and math.isnan(nothing.acceptance)


def test_exceptions_at_a_colliding_centre_may_remain() -> None:
    model = sscc.Model(*two_triangles())
    certs = model.certify(center=[-1.0])
    assert certs.exceptions.tolist() == [[0, 1]]
    assert certs.resolve([-1.0]).change == 0  # exceptions may keep colliding
    assert certs.resolve([-1.0], all=True) == (False, None, math.inf, math.inf)
    found = certs.resolve([-1.0], [0.5], all=True)
    assert found.q is not None and -1 < found.q[0] < -0.999
    samples = certs.free_samples([[-1.0], [0.5]], resolve=False)
    assert samples.q.tolist() == [[0.5]] and samples.acceptance == 0.5


def test_invalid_arguments(certs: sscc.Certificates) -> None:
    colliding = samples(60, 6, 0.4)
    start = colliding[certs.check_many(colliding).colliding][0]
    with pytest.raises(ValueError, match=r"^start: the start collides"):
        certs.resolve(np.zeros(6), start)
    with pytest.raises(ValueError, match=r"^start has 2 "):
        certs.resolve(np.zeros(6), [0.0, 0.0])
    with pytest.raises(ValueError, match=r"^q has 5 "):
        certs.resolve(np.zeros(5))
    with pytest.raises(ValueError, match=r"^draws\[1\]\[2\] is NaN"):
        certs.free_samples([[0.0] * 6, [0.0, 0.0, np.nan, 0.0, 0.0, 0.0]])
    with pytest.raises(ValueError, match=r"^draws has shape \[6\]: \(n, 6\) was expected"):
        certs.free_samples(np.zeros(6))
    unused: list[dict[str, Any]] = [{"start": np.zeros(6)}, {"all": True}]
    for argument in unused:
        with pytest.raises(ValueError, match="^resolve is False, so start and all have no effect: leave them out"):
            certs.free_samples(np.zeros((2, 6)), resolve=False, **argument)
    with pytest.raises(TypeError, match="all is a "):
        certs.resolve(np.zeros(6), all="yes")  # type: ignore[arg-type]
