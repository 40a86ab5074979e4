"""Exact collision detection for deforming triangle meshes.

Any mesh, at given positions:

>>> sscc.self_intersections(vertices, faces)
>>> sscc.Detector(faces, rest).check(positions).pairs

A mesh that deforms by modes, ``x = p + U q``:

>>> certs = sscc.Model(vertices, faces, modes).certify()
>>> certs.check(q).pairs
"""

from sscc import modes
from sscc._curve import Curve
from sscc._sscc import (
    Answer,
    Batch,
    Certificates,
    Detector,
    DetectorAnswer,
    DetectorBatch,
    DetectorImpacts,
    Hierarchy,
    Impacts,
    KineticQuery,
    Model,
    __version__,
    self_intersections,
)
from sscc._penetration import BodyPenetration
from sscc._resolve import FreeSamples, Resolved
from sscc._scene import Scene, SceneAnimation, SceneAnswer, SceneNode
from sscc._simulate import Simulation, simulate
from sscc._sweep import Interval, Intervals, Sweep
from sscc.simulators import from_mujoco, from_simplicits, from_sofa
from sscc.usd import UsdMesh, from_usd

__all__ = [
    "BodyPenetration",
    "Answer",
    "Batch",
    "Certificates",
    "Curve",
    "Detector",
    "DetectorAnswer",
    "DetectorBatch",
    "DetectorImpacts",
    "FreeSamples",
    "Hierarchy",
    "Impacts",
    "Interval",
    "Intervals",
    "KineticQuery",
    "Model",
    "Resolved",
    "Scene",
    "SceneAnimation",
    "SceneAnswer",
    "SceneNode",
    "Simulation",
    "Sweep",
    "UsdMesh",
    "__version__",
    "from_mujoco",
    "from_simplicits",
    "from_sofa",
    "from_usd",
    "modes",
    "self_intersections",
    "simulate",
]
