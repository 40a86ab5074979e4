"""Exact self-collision detection for deformable triangle meshes: a mesh deforms by modes, ``x = p + U q``.

>>> model = sscc.Model(vertices, faces, modes)
>>> certs = model.certify()
>>> certs.check(q).pairs
"""

from sscc import modes
from sscc._sscc import (
    Answer,
    Batch,
    Certificates,
    Hierarchy,
    Impacts,
    KineticQuery,
    Model,
    __version__,
)
from sscc._simulate import Simulation, simulate

__all__ = [
    "Answer",
    "Batch",
    "Certificates",
    "Hierarchy",
    "Impacts",
    "KineticQuery",
    "Model",
    "Simulation",
    "__version__",
    "modes",
    "simulate",
]
