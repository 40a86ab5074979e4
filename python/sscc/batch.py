"""Certificates of many models or of one large model, and queries of many configurations, by ``dask.distributed``.

Every function takes a ``distributed.Client``. Results equal those of one process, byte for byte. Workers need only this
package: the client sends them the models. dask repeats the jobs of a lost worker on another one.

Needs ``pip install './python[dask]'``.
"""

from __future__ import annotations

import os
import pickle
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from sscc import _progress
from sscc._files import escaped
from sscc._seal import unseal
from sscc._sscc import (
    Batch,
    Certificates,
    Model,
    _certificates,
    _certify_in_shards,
    _check_options,
    _configurations,
    _joined,
)
from sscc._text import counted
from sscc._worker import as_given, certify_whole, check_chunk, content_of, do_job, key_of_chunk, key_of_model

try:
    import dask
    from distributed import Client, Future, as_completed
except ImportError as _missing:
    _MESSAGE = "sscc.batch needs dask.distributed, which is not installed: pip install './python[dask]'"
    raise ImportError(_MESSAGE) from _missing

__all__ = ["Library", "certify", "certify_in_shards", "check"]

#: Number of models sent for each thread of the workers: one in work, one waiting.
_WAITING = 2

#: Number of jobs of one stage for each thread of the workers, so that all threads have work until the end.
_JOBS = 4

#: Disables a warning: large data are arguments of tasks, so that the scheduler can send them to another worker.
_LARGE = {"distributed.admin.large-graph-warning-threshold": "1TB"}


@dataclass(repr=False)
class Library:
    """Results of a library of models, by name, in the given order."""

    #: Certificates of the certified models.
    certificates: dict[str, Certificates] = field(default_factory=dict)
    #: Errors of the other models. Each message begins with the name.
    failures: dict[str, Exception] = field(default_factory=dict)

    def __repr__(self) -> str:
        return f"<sscc.batch.Library: {counted(len(self.certificates), 'model')} certified, {len(self.failures):,} failed>"


def certify(
    models: Mapping[str, Model | str | os.PathLike[str]] | Iterable[Model | str | os.PathLike[str]],
    client: Client,
    *,
    progress: Any = None,
    **options: Any,
) -> Library:
    """Certifies each model of a library on a worker.

    models: models or files, or a mapping from names to them. Without a mapping, the name of a file is its path, and the
        name of a model its index (``models[3]``). The client reads a file when a worker can take it.
    progress, options: as in ``Model.certify``, without ``clearance`` and ``rings``; the same for all models. ``threads`` is 1 by
        default.

    The error of a model that cannot be read or certified is in ``failures``; the other models are certified.
    """
    _check_client(client)
    options = {"threads": 1, **options}
    _check_options(None, options)
    named = _named(models)
    library = Library()
    done: dict[str, Certificates | Exception] = {}
    waiting: dict[Future, tuple[str, Model, bytes]] = {}
    names = iter(named)
    shown = _progress.start(progress, "certifying")

    def send() -> Future | None:
        """Sends the next readable model; returns None after the last."""
        for name in names:
            try:
                model = _model(named[name])
                _check_options(model, options)
            except Exception as error:
                done[name] = error
                continue
            of = key_of_model(model, options)
            future = _submit(client, certify_whole, model, options)
            waiting[future] = (name, model, of)
            return future
        return None

    try:
        sent = [future for _ in range(_WAITING * _threads(client)) if (future := send()) is not None]
        arriving = as_completed(sent)
        for future in arriving:
            name, model, of = waiting.pop(future)
            try:
                done[name] = _certificates(unseal(of, future.result()), model)
            except Exception as error:
                done[name] = error
            future.release()
            if (following := send()) is not None:
                arriving.add(following)
            if shown:
                shown[0](len(done) / len(named))
    finally:
        _drop(client, waiting)
        if shown:
            shown[1]()
    for name in named:
        result = done[name]
        if isinstance(result, Certificates):
            library.certificates[name] = result
        else:
            library.failures[name] = _named_error(name, result)
    return library


def certify_in_shards(
    model: Model, client: Client, *, shards: int | None = None, progress: Any = None, **options: Any
) -> Certificates:
    """Certifies one large model on all workers.

    The work has a few dozen stages. Each worker process prepares the model once.

    shards: largest number of jobs of one stage. None means four for each thread of the workers. A job uses one thread. The
        certificates do not depend on the number of jobs.
    progress, options: as in ``Model.certify``, without ``clearance`` and ``rings``; ``threads`` is the number of threads of the
        client.
    """
    _check_client(client)
    if not isinstance(model, Model):
        raise TypeError(f"model is a {type(model).__name__}: a sscc.Model was expected; for many models use certify")
    _check_options(model, options)
    if shards is None:
        shards = _JOBS * _threads(client)
    held = _hold(client, (model, {**options, "threads": 1}))
    shown = _progress.start(progress, "certifying")

    def run(jobs: list[bytes], share: float) -> list[bytes]:
        if shown:
            shown[0](share)
        futures = [_submit(client, do_job, held, job) for job in jobs]
        try:
            results: list[bytes] = client.gather(futures)
            return results
        finally:
            _drop(client, futures)

    try:
        certificates = _certify_in_shards(model, options, shards, run)
        if shown:
            shown[0](1.0)
        return certificates
    finally:
        _drop(client, [held])
        if shown:
            shown[1]()


def check(
    certificates: Certificates,
    Q: Any,
    client: Client,
    *,
    limit: int | None = None,
    chunk: int = 4096,
    progress: Any = None,
) -> Batch:
    """Answers every row of Q (n, r) as ``certificates.check_many`` does; ``chunk`` is the number of rows of a task."""
    _check_client(client)
    if not isinstance(certificates, Certificates):
        raise TypeError(f"certificates is a {type(certificates).__name__}: sscc.Certificates were expected")
    if isinstance(chunk, bool) or not isinstance(chunk, int) or chunk < 1:
        raise ValueError(f"chunk is {chunk!r}: a whole number of at least 1 was expected")
    rows = _configurations(certificates, Q)
    if len(rows) == 0:
        return certificates.check_many(rows, limit, progress=False)
    # Checks the limit before anything is sent.
    certificates.check_many(rows[:0], limit, progress=False)
    shown = _progress.start(progress, "checking")
    held = _hold(client, certificates)
    content = content_of(certificates)
    chunks = [rows[start : start + chunk] for start in range(0, len(rows), chunk)]
    futures = [_submit(client, check_chunk, held, part, limit) for part in chunks]
    try:
        for count, _ in enumerate(as_completed(futures), 1):
            if shown and count < len(futures):
                shown[0](count / len(futures))
        answers = client.gather(futures)
        keys = (key_of_chunk(content, part, limit) for part in chunks)
        joined = _joined([pickle.loads(unseal(of, sealed)) for of, sealed in zip(keys, answers)])
        if shown:
            shown[0](1.0)
        return joined
    finally:
        _drop(client, [held, *futures])
        if shown:
            shown[1]()


def _hold(client: Client, data: object) -> Future:
    """Sends data for many tasks, as the result of a task, so that the scheduler restores them after a lost worker."""
    return _submit(client, as_given, pickle.dumps(data))


def _submit(client: Client, task: Any, *arguments: Any) -> Future:
    with dask.config.set(_LARGE):
        return client.submit(task, *arguments, pure=False)


def _drop(client: Client, futures: Iterable[Future]) -> None:
    """Cancels unfinished tasks and releases finished ones."""
    futures = list(futures)
    if futures and client.status == "running":
        client.cancel(futures)


def _threads(client: Client) -> int:
    threads: dict[str, int] = client.nthreads()
    return max(1, sum(threads.values()))


def _model(given: Model | str | os.PathLike[str]) -> Model:
    if isinstance(given, Model):
        return given
    if isinstance(given, (str, os.PathLike)):
        return Model.load(given)
    raise TypeError(f"a {type(given).__name__}: a sscc.Model or the name of a file was expected")


def _named(models: Any) -> dict[str, Any]:
    if isinstance(models, (Model, str, os.PathLike)):
        raise TypeError("models is a single model: pass a list or a mapping, or use certify_in_shards")
    named: dict[str, Any] = {}
    if isinstance(models, Mapping):
        for given, model in models.items():
            name = str(given)
            if name in named:
                raise ValueError(f"models: {given!r} is {escaped(name)} again: each name may occur once")
            named[name] = model
        return named
    for place, model in enumerate(models):
        name = os.fspath(model) if isinstance(model, (str, os.PathLike)) else f"models[{place}]"
        if name in named:
            raise ValueError(f"models[{place}] is {escaped(name)} again: each name may occur once")
        named[name] = model
    return named


def _named_error(name: str, error: Exception) -> Exception:
    """Returns the same error with a message that begins with the name."""
    text, name = str(error), escaped(name)
    if text.startswith(name):
        return error
    made: Exception
    try:
        made = type(error)(f"{name}: {text}")
    except Exception:
        made = RuntimeError(f"{name}: {text}")
    return made.with_traceback(error.__traceback__)


def _check_client(client: Any) -> None:
    if not isinstance(client, Client) or client.asynchronous:
        found = "an asynchronous client" if isinstance(client, Client) else f"a {type(client).__name__}"
        raise TypeError(f"client is {found}: a distributed.Client was expected, such as Client(address)")


