"""Results, models and certificates can be pickled and sent to other processes."""

from __future__ import annotations

import copy
import multiprocessing
import pickle

import numpy as np
import pytest

import sscc
from shapes import samples


def test_results_round_trip(certs: sscc.Certificates) -> None:
    qs = samples(50, 6, 0.4)
    batch = certs.check_many(qs)
    for result in (batch, *batch, certs.continuous(qs[0], qs[1])):
        for again in (pickle.loads(pickle.dumps(result)), copy.deepcopy(result)):
            assert again == result and type(again) is type(result)
            assert np.array_equal(again.pairs, result.pairs)
    again = pickle.loads(pickle.dumps(certs.continuous(qs[0], qs[1])))
    assert np.array_equal(again.times, certs.continuous(qs[0], qs[1]).times)
    assert certs.check(qs[0]) != certs.check(qs[1])


def test_models_and_certificates_round_trip(certs: sscc.Certificates) -> None:
    model, again = pickle.loads(pickle.dumps((certs.model, certs)))
    assert again.model is model
    assert again.digest == certs.digest and again.root_radius == certs.root_radius
    qs = samples(50, 6, 0.4)
    assert again.check_many(qs) == certs.check_many(qs)
    assert pickle.dumps(again) == pickle.dumps(certs)


def test_damaged_pickles_are_refused() -> None:
    for name in ("_answer", "_batch", "_impacts", "_model", "_certificates"):
        make = getattr(sscc._sscc, name)
        with pytest.raises((TypeError, ValueError)):
            make(b"x")
    with pytest.raises(ValueError, match="damaged"):
        sscc._sscc._answer((b"xyz", 0.0, (True, True, 0, 0, 0)))  # type: ignore[attr-defined]


def colliding(certs: sscc.Certificates, qs: np.ndarray[tuple[int, int], np.dtype[np.float64]]) -> sscc.Batch:
    return certs.check_many(qs, threads=1)


@pytest.mark.parametrize("method", ["spawn", "forkserver"])
def test_other_processes_give_the_same_answers(certs: sscc.Certificates, method: str) -> None:
    qs = samples(40, 6, 0.4)
    with multiprocessing.get_context(method).Pool(2) as pool:
        first, second = pool.starmap(colliding, [(certs, qs[:20]), (certs, qs[20:])])
    assert [*first, *second] == list(certs.check_many(qs))
