"""How results that come from other processes are sealed.

A result is taken only if it arrived whole, and if its key is the one expected: the key is made, on both sides, of the
build, of what was worked on and of the options. (A worker that lies is not found out: workers are trusted as this
process is.)
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
    """What a result must be of."""
    return _hash((_build().encode(), task.encode(), *parts))


def options_bytes(options: Mapping[str, object]) -> bytes:
    """Options as bytes: the same for the same values."""
    written = b""
    for name, value in sorted(options.items()):
        if isinstance(value, (np.ndarray, list, tuple)):
            array = np.ascontiguousarray(value)
            text = f"{name}: {array.dtype} {array.shape} ".encode() + array.tobytes()
        else:
            # Numbers of NumPy are written differently by its versions.
            plain = value.item() if isinstance(value, np.generic) else value
            text = f"{name}: {plain!r}".encode()
        written += len(text).to_bytes(8, "little") + text
    return written


def seal(key: bytes, content: bytes) -> bytes:
    """The content between its key and a hash of both."""
    return key + content + _hash((key, content))


def unseal(key: bytes, sealed: bytes) -> bytes:
    """The content, if it arrived whole and is of this key."""
    found, content, hashed = sealed[:_SIZE], sealed[_SIZE:-_SIZE], sealed[-_SIZE:]
    if len(sealed) < 2 * _SIZE or _hash((found, content)) != hashed:
        raise ValueError("a result is damaged: it was cut off or changed on its way")
    if found != key:
        raise ValueError(
            f"a result is of another model, other options or another build of sscc (here {_build()}): "
            "install the same version everywhere"
        )
    return content
