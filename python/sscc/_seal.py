"""Seals of results that other processes compute.

A result is accepted only if it is complete and has the expected key. Both sides compute the key from the build, the
model and the options. Seals detect damaged and mixed-up results. They do not detect malicious workers.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping

import numpy as np

from sscc._sscc import _build

_SIZE = 32


def _hash(parts: tuple[bytes, ...]) -> bytes:
    digest = hashlib.blake2b(digest_size=_SIZE)
    for part in parts:
        digest.update(len(part).to_bytes(8, "little"))
        digest.update(part)
    return digest.digest()


def key(task: str, *parts: bytes) -> bytes:
    """Returns the key of the results of a task on these data."""
    return _hash((_build().encode(), task.encode(), *parts))


def options_bytes(options: Mapping[str, object]) -> bytes:
    """Returns options as bytes. Equal values of equal types have equal bytes."""
    written = b""
    for name, value in sorted(options.items()):
        if isinstance(value, (np.ndarray, list, tuple)):
            array = np.ascontiguousarray(value)
            text = f"{name}: {array.dtype} {array.shape} ".encode() + array.tobytes()
        else:
            # The text of NumPy's scalars depends on the version of NumPy.
            plain = value.item() if isinstance(value, np.generic) else value
            text = f"{name}: {plain!r}".encode()
        written += len(text).to_bytes(8, "little") + text
    return written


def seal(key: bytes, content: bytes) -> bytes:
    """Returns the key, the content and a hash of both, joined."""
    return key + content + _hash((key, content))


def unseal(key: bytes, sealed: bytes) -> bytes:
    """Returns the content. Raises ValueError if it is damaged or has another key."""
    found, content, hashed = sealed[:_SIZE], sealed[_SIZE:-_SIZE], sealed[-_SIZE:]
    if len(sealed) < 2 * _SIZE or _hash((found, content)) != hashed:
        raise ValueError("a result is damaged: it was truncated or changed in transfer")
    if found != key:
        raise ValueError(
            f"a result belongs to another model, other options or another build of sscc (this process has {_build()}): "
            "use the same model, options and version on all machines"
        )
    return content
