"""Short texts for ``repr``."""

from __future__ import annotations

#: Longest name of a mode, scene or folder in a text.
_LONGEST = 40


def counted(count: int, noun: str) -> str:
    """A number with its noun: "1 pair", "2,000 pairs"."""
    return f"{count:,} {noun}" if count == 1 else f"{count:,} {noun}s"


def number(value: float) -> str:
    """A number with four digits."""
    return f"{value:.4g}"


def quoted(text: object) -> str:
    """A name in quotes, on one line; the end of a long one is left out."""
    shown = repr(str(text))
    return shown if len(shown) <= _LONGEST else f"{shown[: _LONGEST - 4]}...{shown[0]}"
