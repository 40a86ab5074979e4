"""The penetration of two closed meshes: their shared volume, and its depth."""

from __future__ import annotations

from typing import NamedTuple

from sscc._text import number


class BodyPenetration(NamedTuple):
    """The result of ``Detector.penetration``; each number comes with a bound of its error."""

    volume: float
    """The volume of the space inside both meshes, within ``volume_error``. Where a mesh crosses itself, volume counts as often as
    its winding number."""
    volume_error: float
    depth: float
    """The diameter of a ball inside both meshes, nearly the largest, or 0 if there is none: no such ball has a larger diameter
    than ``depth + depth_error``."""
    depth_error: float

    def __repr__(self) -> str:
        return f"<sscc.BodyPenetration: volume {number(self.volume)}, depth {number(self.depth)}>"
