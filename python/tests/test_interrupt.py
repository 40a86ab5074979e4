"""Long calls report their progress, and stop within a second of Ctrl-C or an exception of the progress function."""

from __future__ import annotations

import json
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

import sscc
from scenes import character
from shapes import samples, torus

#: Maximum time until work stops, in processor time of all cores, so that other work on the machine does not count.
MAX_SECONDS = 1.0 * (os.cpu_count() or 1)


@pytest.fixture(autouse=True)
def ctrl_c_handler() -> Iterator[None]:
    """Enables Ctrl-C, which a process that a shell started in the background would ignore."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.fixture(scope="module")
def large() -> sscc.Model:
    """Returns a torus of 57,600 triangles: its certificates take long."""
    return sscc.Model(*torus(240, 120, 12))


@pytest.fixture(scope="module")
def medium() -> sscc.Model:
    """Returns a torus of 12,768 triangles: its certificates take seconds."""
    return sscc.Model(*torus(112, 57, 12))


@pytest.fixture(scope="module")
def one_point() -> sscc.Certificates:
    """Returns certificates of a torus that is one point at q = 1: all pairs of triangles collide, so queries take minutes."""
    vertices, faces, _ = torus(90, 45, 1)
    return sscc.Model(vertices, faces, -vertices[:, :, None]).certify(scheme="paper", epsilon=0.9)


def seconds_until_stopped(work: Callable[[], object], after: float = 0.3) -> float:
    """Presses Ctrl-C during the work, and returns the processor time until it stops (s)."""
    pressed = []

    def press() -> None:
        pressed.append(time.process_time())
        os.kill(os.getpid(), signal.SIGINT)

    timer = threading.Timer(after, press)
    timer.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            work()
    finally:
        timer.cancel()
        timer.join()
    return time.process_time() - pressed[0]


def test_certify_stops_on_ctrl_c(large: sscc.Model) -> None:
    assert seconds_until_stopped(large.certify) < MAX_SECONDS


def test_check_many_stops_on_ctrl_c(certs: sscc.Certificates, one_point: sscc.Certificates) -> None:
    many, long = samples(1_000_000, 6, 0.5), np.ones((4, 1))
    assert seconds_until_stopped(lambda: certs.check_many(many)) < MAX_SECONDS
    assert seconds_until_stopped(lambda: one_point.check_many(long)) < MAX_SECONDS


def test_single_queries_stop_on_ctrl_c(one_point: sscc.Certificates) -> None:
    assert seconds_until_stopped(lambda: one_point.check([1.0])) < MAX_SECONDS
    assert seconds_until_stopped(lambda: one_point.continuous([0.9], [1.0])) < MAX_SECONDS
    assert seconds_until_stopped(lambda: one_point.kinetic().check([1.0])) < MAX_SECONDS
    assert one_point.check([0.0]).count == 0


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="this system has no interval timers")
def test_a_signal_handler_cannot_use_the_query_that_it_interrupted(one_point: sscc.Certificates) -> None:
    kinetic, other = one_point.kinetic(), one_point.kinetic()

    def handle(_signal: int, _frame: object) -> None:
        assert not other.check([0.0]).colliding
        kinetic.check([0.0])

    before = signal.signal(signal.SIGALRM, handle)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.3)
        with pytest.raises(RuntimeError, match="^this KineticQuery is already in a call"):
            kinetic.check([1.0])
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
    assert not kinetic.check([0.0]).colliding


def test_builders_of_modes_stop_on_ctrl_c() -> None:
    vertices, faces, _ = torus(30, 20, 1)
    shapes = vertices + np.random.default_rng(3).normal(size=(1000, 600, 3))
    assert seconds_until_stopped(lambda: sscc.modes.pca(shapes, faces)) < MAX_SECONDS
    assert seconds_until_stopped(lambda: sscc.modes.linear((vertices, faces), 100, resolution=60)) < MAX_SECONDS
    with pytest.raises(ZeroDivisionError):
        sscc.modes.linear((vertices, faces), 8, resolution=20, progress=lambda share: 1 / 0)


def test_positions_of_scenes_stop_on_ctrl_c(tmp_path: Path) -> None:
    path = character(tmp_path)
    content = json.loads(path.read_text())
    content["nodes"] += [{"name": "light"}] * 5000
    path.write_text(json.dumps(content))
    scene, times = sscc.Scene.load(path), np.linspace(0, 1, 400_000)
    assert seconds_until_stopped(lambda: scene.positions("shirt", "wave", times=times)) < MAX_SECONDS


def test_reading_of_folders_ends_on_ctrl_c(tmp_path: Path) -> None:
    """All files are the same one: a triangle with many copies, which is read slowly and takes little memory."""
    first = tmp_path / "0.obj"
    first.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\n" + "f 1 2 3\n" * 150_000)
    for number in range(1, 500):
        os.link(first, tmp_path / f"{number}.obj")
    assert seconds_until_stopped(lambda: sscc.modes.pca(tmp_path)) < MAX_SECONDS
    assert seconds_until_stopped(lambda: sscc.Model.load(first, tmp_path)) < MAX_SECONDS
    # The work in the background ends at the next file.
    for path in tmp_path.iterdir():
        path.unlink()


def test_queries_work_after_an_interruption(certs: sscc.Certificates) -> None:
    qs = samples(300_000, 6, 0.4)
    expected = certs.check_many(qs[:50])
    kinetic = certs.kinetic()
    with pytest.raises(ZeroDivisionError):
        certs.check_many(qs, progress=lambda share: 1 / 0)
    assert certs.check_many(qs[:50]) == expected
    assert [kinetic.check(q).pairs.tolist() for q in qs[:50]] == [a.pairs.tolist() for a in expected]


def test_progress_ascends_to_one(model: sscc.Model) -> None:
    shares: list[float] = []
    certs = model.certify(progress=shares.append)
    assert shares[-1] == 1.0 and shares == sorted(shares) and 0 < shares[0]
    assert len(certs.hierarchy) > 1


def test_progress_is_one_only_at_the_end() -> None:
    """Certificates are computed beyond the last report, and modes in phases whose reports begin again."""
    vertices, faces, _ = torus(60, 30, 1)
    many: list[Callable[[Callable[[float], object]], object]] = [
        lambda report: sscc.Model(*torus(80, 40, 8)).certify(progress=report),
        lambda report: sscc.modes.linear((vertices, faces), 8, resolution=30, progress=report),
        lambda report: sscc.modes.nonlinear((vertices, faces), 10, resolution=24, progress=report),
        lambda report: sscc.modes.polynomial((vertices, faces), resolution=30, progress=report),
    ]
    for work in many:
        shares: list[float] = []
        work(shares.append)
        assert shares == sorted(shares) and shares[-1] == 1.0 and shares.count(1.0) == 1


def test_refused_work_is_never_finished(certs: sscc.Certificates) -> None:
    shares: list[float] = []
    with pytest.raises(ValueError, match=r"^Q\[0\]\[0\] is NaN"):
        certs.check_many(np.full((3, 6), np.nan), progress=shares.append)
    with pytest.raises(ValueError, match="is empty"):
        certs.sweep((1, 1), progress=shares.append)
    assert 1.0 not in shares


def test_progress_is_reported_during_the_work(medium: sscc.Model) -> None:
    class Enough(Exception):
        pass

    reports: list[tuple[float, threading.Thread]] = []

    def report(share: float) -> None:
        reports.append((share, threading.current_thread()))
        if len(reports) == 3:
            raise Enough("three are enough")

    with pytest.raises(Enough, match="three are enough"):
        medium.certify(progress=report)
    assert 0 < reports[0][0] < reports[-1][0] < 1
    assert len(reports) == 3 and {thread for _, thread in reports} == {threading.current_thread()}


def test_bars_need_a_terminal_and_long_work(model: sscc.Model, capfd: pytest.CaptureFixture[str]) -> None:
    from sscc._progress import Bar, start

    model.certify()
    assert capfd.readouterr() == ("", "")
    assert start(None, "x") is None and start(False, "x") is None
    bar = Bar("certifying")
    bar(0.5)
    bar.close()
    assert capfd.readouterr() == ("", "")  # the work was short
    bar.start -= 10
    bar(0.5)
    bar.close()
    assert capfd.readouterr().err == "\rcertifying [###############...............]  50% 10 s\n"
    begun = start(True, "x")
    assert begun is not None and isinstance(begun[0], Bar)


def test_interrupted_work_leaves_no_file(tmp_path: Path, large: sscc.Model) -> None:
    path = tmp_path / "a.sscc.safetensors"
    assert seconds_until_stopped(lambda: large.certify().save(path)) < MAX_SECONDS
    assert list(tmp_path.iterdir()) == []


def test_progress_functions_stop_work_on_other_threads(medium: sscc.Model) -> None:
    stop = threading.Event()
    raised: list[BaseException] = []

    def report(_share: float) -> None:
        if stop.is_set():
            raise InterruptedError("stopped")

    def work() -> None:
        try:
            medium.certify(progress=report)
        except InterruptedError as error:
            raised.append(error)

    worker = threading.Thread(target=work)
    worker.start()
    stop.set()
    worker.join(60)
    assert not worker.is_alive() and str(raised[0]) == "stopped"
