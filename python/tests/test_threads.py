"""Certificates answer queries of any number of threads at once."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest

import sscc
from shapes import samples, torus, two_triangles

THREADS = 8


def test_eight_threads_get_the_same_answers(certs: sscc.Certificates) -> None:
    qs = samples(160, 6, 0.4)
    expected = [certs.check(q) for q in qs]
    motions = [certs.continuous(q, q / 2) for q in qs[:20]]
    start = threading.Barrier(THREADS)

    def ask(thread: int) -> None:
        start.wait()
        for i in range(len(qs)):
            i = (i + 20 * thread) % len(qs)
            assert certs.check(qs[i]) == expected[i]
            if i < len(motions):
                assert certs.continuous(qs[i], qs[i] / 2) == motions[i]
        assert list(certs.check_many(qs, threads=2)) == expected

    with ThreadPoolExecutor(THREADS) as pool:
        for outcome in [pool.submit(ask, thread) for thread in range(THREADS)]:
            outcome.result()


def test_a_kinetic_query_answers_threads_one_after_the_other(certs: sscc.Certificates) -> None:
    qs = samples(40, 6, 0.4)
    expected = [certs.check(q).pairs.tolist() for q in qs]
    kinetic = certs.kinetic()

    def ask(_thread: int) -> list[object]:
        return [kinetic.check(q).pairs.tolist() for q in qs]

    with ThreadPoolExecutor(THREADS) as pool:
        assert list(pool.map(ask, range(THREADS))) == [expected] * THREADS


def test_later_writes_to_an_array_change_no_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    """A batch answers the rows as they were when the call began."""
    vertices, faces, modes = two_triangles()
    certs = sscc.Model(vertices, faces, modes).certify()
    free, colliding = np.full((50, 1), 0.5), np.full((50, 1), -1.0)
    all_free, all_colliding = certs.check_many(free), certs.check_many(colliding)
    assert all_colliding.colliding.all() and not all_free.colliding.any()
    qs = after = colliding.copy()

    def overwrite(_progress: object, _label: str) -> None:
        qs[:] = after

    # The work begins after this function, on a thread that has the arguments of the call.
    monkeypatch.setattr(sscc._progress, "start", overwrite)
    for before, after, answers in [(colliding, free, all_colliding), (free, colliding, all_free)]:
        qs[:] = before
        assert certs.check_many(qs) == answers
        assert np.array_equal(qs, after)


def test_long_calls_release_the_gil(model: sscc.Model) -> None:
    """Another thread counts while certificates are computed."""
    counted = 0
    done = threading.Event()

    def count() -> None:
        nonlocal counted
        while not done.wait(0.001):
            counted += 1

    counter = threading.Thread(target=count)
    counter.start()
    for _ in range(3):
        model.certify(epsilon=0.02, threads=1)
    done.set()
    counter.join()
    assert counted > 10


def has_run_meanwhile(call: Callable[[], object]) -> bool:
    """Whether another thread runs during the call, which is repeated until it does, for at most a minute.

    Python does not switch threads by itself in this time, so the other thread runs only if the call releases the GIL.
    """
    go, has_run = threading.Event(), threading.Event()

    def run() -> None:
        go.wait()
        has_run.set()

    other = threading.Thread(target=run)
    interval = sys.getswitchinterval()
    sys.setswitchinterval(1000)
    try:
        other.start()
        go.set()
        end = time.monotonic() + 60
        while not has_run.is_set() and time.monotonic() < end:
            call()
        return has_run.is_set()
    finally:
        sys.setswitchinterval(interval)
        go.set()
        other.join()


def test_work_on_large_arrays_releases_the_gil() -> None:
    vertices, faces, modes = torus(120, 60, 12)
    model = sscc.Model(vertices, faces, modes)
    certs = model.certify(scheme="paper", epsilon=0.9)
    elastic = sscc.modes.linear((vertices, faces), 4, resolution=14, fix=[0, 1, 2, 3])
    q, forces = np.full(12, 0.1), np.full((len(vertices), 3), 1e-3)
    classes = np.arange(len(vertices))
    pickled: Any = model.__reduce__()
    calls: dict[str, Callable[[], object]] = {
        "Model": lambda: sscc.Model(vertices, faces, modes),
        "positions": lambda: model.positions(q),
        "fit": lambda: model.fit(vertices),
        "static": lambda: elastic.static(forces),
        "modes": lambda: model.modes,
        "weld": lambda: sscc.Detector(faces, weld=classes),
        "pickling a model": lambda: model.__reduce__(),
        "unpickling a model": lambda: pickled[0](*pickled[1]),
        "pickling certificates": lambda: certs.__reduce__(),
    }
    for name, call in calls.items():
        assert has_run_meanwhile(call), f"{name} holds the GIL"
