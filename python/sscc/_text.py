"""Short texts for ``repr``."""

from __future__ import annotations

#: Maximum length of a name of a mode, scene or folder in a text.
_LONGEST = 40


def counted(count: int, noun: str) -> str:
    """Returns a number with its noun: "1 pair", "2,000 pairs"."""
    return f"{count:,} {noun}" if count == 1 else f"{count:,} {noun}s"


def number(value: float) -> str:
    """Returns a number with four significant digits."""
    return f"{value:.4g}"


def quoted(text: object) -> str:
    """Returns a name in quotes, on one line. The end of a long name is omitted."""
    shown = repr(str(text))
    return shown if len(shown) <= _LONGEST else f"{shown[: _LONGEST - 4]}...{shown[0]}"
