"""`sscc.batch` on a local cluster of two worker processes equals the results of this process, byte for byte."""

from __future__ import annotations

import contextlib
import importlib
import itertools
import os
import pickle
import signal
import subprocess
import sys
import textwrap
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import pytest

import sscc
from shapes import samples, torus
from test_docs import blocks
from sscc._worker import content_of

pytest.importorskip("distributed", reason="dask.distributed is not installed")

from distributed import Client, LocalCluster  # noqa: E402

import sscc.batch  # noqa: E402

pytestmark = pytest.mark.filterwarnings("default")

T = TypeVar("T")

#: Time limit of each step (s), long enough for a busy machine.
TIME_LIMIT = 600


@contextlib.contextmanager
def two_workers() -> Iterator[Any]:
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster,
        Client(cluster) as client,
    ):
        yield client


@pytest.fixture(scope="module")
def client() -> Iterator[Any]:
    with two_workers() as client:
        yield client


@pytest.fixture
def own_client() -> Iterator[Any]:
    """A cluster for one test that kills a worker, because dask does not always start a new worker on a busy machine."""
    with two_workers() as client:
        yield client


def within(work: Callable[[], T], seconds: float = TIME_LIMIT) -> T:
    """Returns the result of the work; fails if the work takes longer than this."""
    found: list[T] = []
    raised: list[BaseException] = []

    def run() -> None:
        try:
            found.append(work())
        except BaseException as error:
            raised.append(error)

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    thread.join(seconds)
    assert not thread.is_alive(), f"the work did not end within {seconds} seconds"
    if raised:
        raise raised[0]
    return found[0]


class Killed:
    """Kills one of the two workers during its n-th call of a function of `sscc._worker`."""

    def __init__(self, client: Any, folder: Path, name: str, call: int) -> None:
        self.started, self.over = folder / "started", threading.Event()
        pids: dict[str, int] = client.run(os.getpid)
        address, started = min(pids), str(self.started)
        self.pid = pids[address]

        def wait_at_call() -> None:
            worker: Any = importlib.import_module("sscc._worker")
            given, calls = getattr(worker, name), itertools.count(1)

            def waiting(*arguments: Any) -> Any:
                if next(calls) == call:
                    Path(started).touch()
                    time.sleep(TIME_LIMIT)
                return given(*arguments)

            setattr(worker, name, waiting)

        client.run(wait_at_call, workers=[address])
        self.thread = threading.Thread(target=self.watch, daemon=True)

    def watch(self) -> None:
        while not self.started.exists():
            if self.over.wait(0.01):
                return
        os.kill(self.pid, signal.SIGKILL)

    def __enter__(self) -> None:
        self.thread.start()

    def __exit__(self, *_: object) -> None:
        self.over.set()
        self.thread.join()
        assert self.started.exists(), "the worker received no task"


def test_certificates_of_a_library_equal_those_of_this_process(client: Any, tmp_path: Path) -> None:
    models: dict[str, Any] = {f"torus {n}": sscc.Model(*torus(16, n, 3)) for n in (8, 10, 12)}
    file = tmp_path / "saved.model.safetensors"
    models["torus 10"].save(file)
    models["from a file"] = file
    library = within(lambda: sscc.batch.certify(models, client, epsilon=0.2))
    assert list(library.certificates) == list(models) and library.failures == {}
    for name, certificates in library.certificates.items():
        model = sscc.Model.load(file) if name == "from a file" else models[name]
        assert content_of(certificates) == content_of(model.certify(epsilon=0.2)), name


def test_a_bad_model_fails_alone_under_its_name(client: Any, tmp_path: Path) -> None:
    good = sscc.Model(*torus(16, 8, 3))
    good.save(tmp_path / "good.model.safetensors")
    data = (tmp_path / "good.model.safetensors").read_bytes()
    (tmp_path / "damaged.model.safetensors").write_bytes(data[:-1] + bytes([data[-1] ^ 1]))
    missing, damaged = (str(tmp_path / f"{name}.model.safetensors") for name in ("missing", "damaged"))
    other_rank = sscc.Model(*torus(16, 8, 2))
    too_large = sscc.Model(*torus(16, 9, 3))

    def with_little_memory() -> None:
        """Leaves workers without memory for the model that is too large."""
        worker: Any = importlib.import_module("sscc._worker")
        given = worker.key_of_model

        def key_of_model(model: sscc.Model, options: dict[str, Any]) -> bytes:
            if len(model.faces) == 2 * 16 * 9:
                raise MemoryError("out of memory")
            found: bytes = given(model, options)
            return found

        worker.key_of_model = key_of_model

    def with_much_memory() -> None:
        importlib.reload(importlib.import_module("sscc._worker"))

    models: list[Any] = [missing, good, damaged, too_large, other_rank, 3]
    client.run(with_little_memory)
    try:
        library = within(lambda: sscc.batch.certify(models, client, center=[0.0, 0.0, 0.0]))
    finally:
        client.run(with_much_memory)
    assert list(library.certificates) == ["models[1]"]
    assert content_of(library.certificates["models[1]"]) == content_of(good.certify(center=[0.0, 0.0, 0.0]))
    assert list(library.failures) == [missing, damaged, "models[3]", "models[4]", "models[5]"]
    for name, error in library.failures.items():
        assert str(error).startswith(name) and "\n" not in str(error)
    assert isinstance(library.failures[missing], FileNotFoundError)
    assert "BLAKE3" in str(library.failures[damaged]) or "damaged" in str(library.failures[damaged])
    assert str(library.failures["models[3]"]) == "models[3]: out of memory"
    assert "center" in str(library.failures["models[4]"])


def test_certificates_by_shards_have_the_same_bytes(client: Any) -> None:
    model = sscc.Model(*torus(24, 12, 5))
    choices: list[dict[str, Any]] = [
        {},
        {"scheme": "paper"},
        {"budget": 64, "weld": True, "neighbours": "include-one-vertex"},
        {"budget": 512, "reach": 3},
    ]
    for options in choices:
        here = content_of(model.certify(**options))
        for shards in (None, 1, 50):
            there = within(lambda: sscc.batch.certify_in_shards(model, client, shards=shards, **options))
            assert content_of(there) == here, (options, shards)


def test_answers_in_chunks_are_the_same(client: Any, certs: sscc.Certificates) -> None:
    Q = samples(1000, 6, 1.0)
    here = certs.check_many(Q)
    assert 0 < here.colliding.sum() < 1000
    for chunk in (64, 999, 5000):
        there = within(lambda: sscc.batch.check(certs, Q, client, chunk=chunk))
        assert there == here and pickle.dumps(there) == pickle.dumps(here)
    limited = within(lambda: sscc.batch.check(certs, np.asfortranarray(Q), client, limit=1, chunk=100))
    assert limited.count.max() == 1 and (limited.colliding == here.colliding).all()
    assert len(within(lambda: sscc.batch.check(certs, np.empty((0, 6)), client))) == 0


#: With SSCC_LONG=1 workers are killed at many calls, else at one call in each kind of task.
LONG = bool(os.environ.get("SSCC_LONG"))
JOBS = [1, 2, 3, 5, 8, 13] if LONG else [3]
OF_MODELS = ["certify_whole", "key_of_model", "content_of", "seal"] if LONG else ["content_of"]
OF_CHUNKS = ["check_chunk", "_prepared", "key_of_chunk", "seal"] if LONG else ["_prepared"]


@pytest.mark.parametrize("call", JOBS)
def test_a_killed_worker_loses_no_shard(own_client: Any, tmp_path: Path, call: int) -> None:
    model = sscc.Model(*torus(32, 16, 6))
    with Killed(own_client, tmp_path, "_prepared", call):
        there = within(lambda: sscc.batch.certify_in_shards(model, own_client))
    assert content_of(there) == content_of(model.certify())


@pytest.mark.parametrize("name", OF_MODELS)
def test_a_killed_worker_loses_no_model(own_client: Any, tmp_path: Path, name: str) -> None:
    models = {f"torus {n}": sscc.Model(*torus(16, n, 3)) for n in (8, 9, 10, 11, 12)}
    with Killed(own_client, tmp_path, name, 1):
        library = within(lambda: sscc.batch.certify(models, own_client, epsilon=0.5))
    assert library.failures == {}
    for model, certificates in library.certificates.items():
        assert content_of(certificates) == content_of(models[model].certify(epsilon=0.5)), model


@pytest.mark.parametrize("name", OF_CHUNKS)
def test_a_killed_worker_loses_no_query(
    own_client: Any, certs: sscc.Certificates, tmp_path: Path, name: str
) -> None:
    Q = samples(2000, 6, 1.0)
    with Killed(own_client, tmp_path, name, 3):
        there = within(lambda: sscc.batch.check(certs, Q, own_client, chunk=50))
    assert there == certs.check_many(Q)


def test_results_of_another_build_are_refused(client: Any, certs: sscc.Certificates) -> None:
    model = sscc.Model(*torus(16, 8, 3))

    def pretend(build: str) -> None:
        seals: Any = importlib.import_module("sscc._seal")
        seals._build = lambda: build

    here = sscc._sscc._build()
    try:
        client.run(pretend, "0.0.0 elsewhere")
        library = within(lambda: sscc.batch.certify([model], client))
        assert "another build" in str(library.failures["models[0]"])
        shares: list[float] = []
        with pytest.raises(ValueError, match="another build"):
            within(lambda: sscc.batch.check(certs, samples(10, 6, 1.0), client, progress=shares.append))
        # Only work without an error reports the share 1.
        assert shares == []
    finally:
        client.run(pretend, here)
    assert within(lambda: sscc.batch.certify([model], client)).failures == {}


def test_errors_name_a_model_once_and_on_one_line() -> None:
    for text in ("a\\nb.obj: not found", "not found"):
        assert str(sscc.batch._named_error("a\nb.obj", OSError(text))) == "a\\nb.obj: not found"


def test_damaged_and_foreign_results_are_refused() -> None:
    from sscc._seal import key, seal, unseal

    mine, other = key("certify", b"model"), key("certify", b"other model")
    sealed = seal(mine, b"content")
    assert unseal(mine, sealed) == b"content"
    with pytest.raises(ValueError, match="another model"):
        unseal(other, sealed)
    for place in range(len(sealed)):
        with pytest.raises(ValueError, match="damaged"):
            unseal(mine, sealed[:place])
        with pytest.raises(ValueError, match="damaged"):
            unseal(mine, sealed[:place] + bytes([sealed[place] ^ 4]) + sealed[place + 1 :])
    with pytest.raises(ValueError, match="damaged"):
        unseal(mine, sealed + b"0")


def test_keys_are_the_same_for_numbers_of_numpy() -> None:
    from sscc._seal import options_bytes
    from sscc._worker import key_of_chunk

    plain = options_bytes({"epsilon": 0.5, "budget": 8, "weld": True})
    assert options_bytes({"epsilon": np.float64(0.5), "budget": np.int32(8), "weld": np.True_}) == plain
    assert options_bytes({"epsilon": 0.5, "budget": 9, "weld": True}) != plain
    limit: Any = np.int64(2)
    rows = np.zeros((1, 3))
    assert key_of_chunk(b"", rows, limit) == key_of_chunk(b"", rows, 2) != key_of_chunk(b"", rows, None)


def test_the_client_refuses_bad_arguments(client: Any, certs: sscc.Certificates) -> None:
    model = certs.model
    Q = samples(10, 6, 1.0)
    Q[7, 2] = np.nan
    check: Any = sscc.batch.check
    certify: Any = sscc.batch.certify
    in_shards: Any = sscc.batch.certify_in_shards
    with pytest.raises(ValueError, match=r"^Q\[7\]\[2\] is NaN"):
        check(certs, Q, client)
    with pytest.raises(TypeError, match="masked"):
        check(certs, np.ma.MaskedArray(Q, np.isnan(Q)), client)
    with pytest.raises(ValueError, match=r"Q has shape \[10, 5\]"):
        check(certs, Q[:, :5], client)
    with pytest.raises(ValueError, match="chunk is 0"):
        check(certs, Q[:5], client, chunk=0)
    with pytest.raises(ValueError, match="limit is 0"):
        check(certs, Q[:5], client, limit=0)
    with pytest.raises(TypeError, match="certificates is a Model"):
        check(model, Q, client)
    for refused in (None, "tcp://127.0.0.1:8786"):
        with pytest.raises(TypeError, match="distributed.Client was expected"):
            check(certs, Q, refused)
    with pytest.raises(TypeError, match="'epsilom' is not an option"):
        certify([model], client, epsilom=0.1)
    with pytest.raises(TypeError, match="certify_in_shards"):
        certify(model, client)
    with pytest.raises(ValueError, match=r"models\[1\] is a.obj again"):
        certify(["a.obj", "a.obj"], client)
    with pytest.raises(ValueError, match="^models: '1' is 1 again"):
        certify({1: model, "1": model}, client)
    with pytest.raises(ValueError, match="epsilon is 2"):
        in_shards(model, client, epsilon=2)
    with pytest.raises(ValueError, match="shards is 0"):
        in_shards(model, client, shards=0)
    with pytest.raises(TypeError, match="model is a list"):
        in_shards([model], client)


def test_only_the_client_reports_progress(
    client: Any, model: sscc.Model, certs: sscc.Certificates, capfd: Any
) -> None:
    shares: list[float] = []
    within(lambda: sscc.batch.certify_in_shards(model, client, progress=shares.append))
    assert shares == sorted(shares) and shares[0] == 0 and shares[-1] == 1
    shares.clear()
    within(lambda: sscc.batch.certify([model, model], client, progress=shares.append))
    assert shares == [0.5, 1]
    shares.clear()
    within(lambda: sscc.batch.check(certs, samples(10, 6, 1.0), client, chunk=5, progress=shares.append))
    assert shares == [0.5, 1]
    assert "certifying" not in capfd.readouterr().err


def test_the_error_without_dask_names_the_package(tmp_path: Path) -> None:
    code = "import sys; sys.modules['distributed'] = None; import sscc; import sscc.batch"
    # The folder is another one: python -c imports from the current folder first, and the source here is not built.
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 1
    assert done.stderr.splitlines()[-1].endswith("pip install './python[dask]'")


def test_the_document_runs_as_a_script(tmp_path: Path) -> None:
    first, *others = blocks("docs/batch.md")
    shown = """
    print(library.certificates["plates"].root_radius, type(library.failures["lost"]).__name__)
    print(answers.colliding.sum(), len(answers))
"""
    script = tmp_path / "script.py"
    script.write_text(first + "".join(textwrap.indent(block, "    ") for block in others) + shown)
    done = subprocess.run([sys.executable, script], cwd=tmp_path, capture_output=True, text=True, timeout=TIME_LIMIT)
    assert done.returncode == 0, done.stderr
    radius, lost, colliding, rows = done.stdout.split()
    assert 0.8 <= float(radius) <= 1 and lost == "FileNotFoundError"
    # Between -2 and 2 the triangles touch only at -1, which is not among the rows.
    assert colliding == "0" and rows == "10000"
