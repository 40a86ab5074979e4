"""What the argument ``progress`` of long calls means."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

#: Work shorter than this (seconds) shows no bar.
PATIENCE = 0.5
WIDTH = 30


class Bar:
    """A bar on standard error, which appears when the work takes long."""

    def __init__(self, label: str) -> None:
        self.label = label
        self.start = time.monotonic()
        self.shown = False

    def __call__(self, share: float) -> None:
        seconds = time.monotonic() - self.start
        if seconds < PATIENCE and not self.shown:
            return
        self.shown = True
        done = int(share * WIDTH)
        bar = "#" * done + "." * (WIDTH - done)
        sys.stderr.write(f"\r{self.label} [{bar}] {share:4.0%} {seconds:.0f} s")
        sys.stderr.flush()

    def close(self) -> None:
        if self.shown:
            sys.stderr.write("\n")


def is_watched() -> bool:
    """Whether somebody looks at standard error: a terminal or a notebook."""
    if sys.stderr is None:
        return False
    if sys.stderr.isatty():
        return True
    # Whoever is in a notebook has imported IPython.
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    return type(shell).__name__ == "ZMQInteractiveShell"


Tell = Callable[[float], object]


def start(progress: Tell | bool | None, label: str) -> tuple[Tell, Callable[[], object]] | None:
    """What is to be told the share of the work that is done, if anything, and what is to be called at its end."""
    if progress is False or progress is None and not is_watched():
        return None
    if progress is None or progress is True:
        bar = Bar(label)
        return bar, bar.close
    if not callable(progress):
        found = type(progress).__name__
        raise TypeError(f"progress is a {found}: a function of one number, True, False or None was expected")
    return progress, lambda: None
