"""Files that the parts of the package in Python read."""

from __future__ import annotations

import os
import stat
from os import PathLike


def escaped(path: str | PathLike[str]) -> str:
    """Returns a path for a message: on one line, with control characters escaped."""
    text = os.fsdecode(path)
    return text if text.isprintable() else repr(text)[1:-1]


def check_regular(path: str | PathLike[str]) -> None:
    """Refuses folders, devices and pipes, which have no size that bounds the bytes read."""
    # The check comes before opening: opening a pipe waits for a writer.
    mode = os.stat(path).st_mode
    if not stat.S_ISREG(mode):
        found = "a directory" if stat.S_ISDIR(mode) else "a device or pipe"
        raise OSError(f"{escaped(path)}: is {found}, a file was expected")
