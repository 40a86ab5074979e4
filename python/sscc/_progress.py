"""The argument ``progress`` of long calls."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

#: Work of less than this time shows no bar (seconds).
MIN_SECONDS = 0.5
#: Number of characters of the bar.
WIDTH = 30


class Bar:
    """A bar on standard error, for work that takes long."""

    def __init__(self, label: str) -> None:
        self.label = label
        self.start = time.monotonic()
        self.shown = False

    def __call__(self, share: float) -> None:
        seconds = time.monotonic() - self.start
        if seconds < MIN_SECONDS and not self.shown:
            return
        self.shown = True
        done = int(share * WIDTH)
        bar = "#" * done + "." * (WIDTH - done)
        sys.stderr.write(f"\r{self.label} [{bar}] {share:4.0%} {seconds:.0f} s")
        sys.stderr.flush()

    def close(self) -> None:
        if self.shown:
            sys.stderr.write("\n")


def is_interactive() -> bool:
    """Whether standard error is a terminal or belongs to a notebook."""
    if sys.stderr is None:
        return False
    if sys.stderr.isatty():
        return True
    # IPython is imported in a notebook.
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    return type(shell).__name__ == "ZMQInteractiveShell"


#: Receives the finished share of the work, from 0 to 1.
Report = Callable[[float], object]


def start(progress: Report | bool | None, label: str) -> tuple[Report, Callable[[], object]] | None:
    """Returns two functions: one receives the finished share, one ends the report. Returns None if nothing is reported."""
    if progress is False or progress is None and not is_interactive():
        return None
    if progress is None or progress is True:
        bar = Bar(label)
        return bar, bar.close
    if not callable(progress):
        found = type(progress).__name__
        raise TypeError(f"progress is a {found}: a function of one number, True, False or None was expected")
    return progress, lambda: None
