"""How deep two closed meshes are in each other."""

from __future__ import annotations

from typing import NamedTuple

from sscc._text import number


class BodyPenetration(NamedTuple):
    """The result of ``Detector.penetration``; each number comes with a bound of its error."""

    volume: float
    """The volume that both meshes have inside, within ``volume_error``."""
    volume_error: float
    depth: float
    """The diameter of a ball inside of both, nearly the largest: none is larger than ``depth + depth_error``."""
    depth_error: float

    def __repr__(self) -> str:
        return f"<sscc.BodyPenetration: volume {number(self.volume)}, depth {number(self.depth)}>"
