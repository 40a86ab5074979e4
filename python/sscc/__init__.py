"""Proven self-collision detection for deformable models: a mesh that deforms by modes, ``x = p + U q``.

>>> model = sscc.Model(vertices, faces, modes)
>>> certs = model.certify()
>>> certs.check(q).pairs
"""

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

__all__ = [
    "Answer",
    "Batch",
    "Certificates",
    "Hierarchy",
    "Impacts",
    "KineticQuery",
    "Model",
    "__version__",
]
