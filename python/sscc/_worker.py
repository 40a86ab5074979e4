"""Tasks of `sscc.batch` that workers run. This module does not need dask."""

from __future__ import annotations

import hashlib
import operator
import pickle
import threading
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sscc._seal import key, options_bytes, seal
from sscc._sscc import Certificates, Model, _ShardWorker


def as_given(data: bytes) -> bytes:
    """Returns the data, so that other tasks can use this result."""
    return data


def certify_whole(model: Model, options: dict[str, Any]) -> bytes:
    """Computes the certificates of a model, and returns them sealed."""
    certificates = model.certify(**options, progress=False)
    return seal(key_of_model(model, options), content_of(certificates))


def check_chunk(held: bytes, rows: NDArray[np.float64], limit: int | None) -> bytes:
    """Answers rows of Q, and returns the answers pickled and sealed. held: the pickled certificates."""
    certificates, content = _prepared(held, lambda certificates: (certificates, content_of(certificates)))
    answers = certificates.check_many(rows, limit, threads=1, progress=False)
    return seal(key_of_chunk(content, rows, limit), pickle.dumps(answers))


def do_job(held: bytes, job: bytes) -> bytes:
    """Returns the result of a job of one large model, which the core seals. held: the pickled model and options."""
    worker: _ShardWorker = _prepared(held, lambda model_and_options: _ShardWorker(*model_and_options))
    return worker.run(job)


def content_of(whole: Model | Certificates) -> bytes:
    """Returns a model or certificates as the bytes of their file."""
    content: bytes = _reduced(whole)[0]
    return content


def _reduced(whole: Model | Certificates) -> Any:
    """Returns the pickled arguments; the first is the bytes of the file."""
    reduced: Any = whole.__reduce__()
    return reduced[1]


def key_of_model(model: Model, options: dict[str, Any]) -> bytes:
    content, *_, is_split = _reduced(model)
    return key("certify", content, repr(is_split).encode(), options_bytes(options))


def key_of_chunk(content: bytes, rows: NDArray[np.float64], limit: int | None) -> bytes:
    plain = None if limit is None else operator.index(limit)
    return key("check", content, repr(plain).encode(), np.ascontiguousarray(rows).tobytes())


#: The hash of the object that this process prepared last, and the prepared result.
_last: tuple[bytes, Any] = (b"", None)
_preparing = threading.Lock()


def _prepared(held: bytes, prepare: Callable[[Any], Any]) -> Any:
    """Returns `prepare` of the pickled object. Computes it again only when the object changes."""
    global _last
    name = hashlib.blake2b(held).digest()
    with _preparing:
        if _last[0] != name:
            _last = (b"", None)
            _last = (name, prepare(pickle.loads(held)))
        return _last[1]
