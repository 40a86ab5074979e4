"""The status of an object, for the panel and the mark."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np


@dataclass(frozen=True)
class Status:
    """The status of an object. ``kind`` is free, colliding, changed, uncertified or unsupported."""

    kind: str
    text: str
    polygons: np.ndarray = field(default_factory=lambda: np.empty(0, np.int64))  #: colliding polygons, ascending
    corners: np.ndarray = field(default_factory=lambda: np.empty((0, 3)))  #: of the colliding triangles, three each


def colliding(pairs: np.ndarray, polygons: np.ndarray, positions: np.ndarray, faces: np.ndarray) -> Status:
    """Returns the status of a shape with colliding pairs of triangles. polygons: of each triangle."""
    triangles = np.unique(pairs)
    found = np.unique(polygons[triangles])
    corners = positions[faces[triangles].reshape(-1)]
    collide = "1 face collides" if len(found) == 1 else f"{len(found):,} faces collide"
    of_triangles = "1 pair" if len(pairs) == 1 else f"{len(pairs):,} pairs"
    return Status("colliding", f"{collide} ({of_triangles} of triangles)", found, corners)
