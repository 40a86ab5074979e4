"""Certificates by fingerprint, and what may be said of an object now.

Certificates are found by the content of mesh and keys, read anew each time that something is said. So nothing that was
said of one shape can be on show for another one; and what is undone is certified again at once.
"""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass, field

import bpy
import numpy as np
import sscc

from . import shape as shapes
from .shape import Unsupported

#: So many shapes are remembered.
REMEMBERED = 8

#: Names the fingerprint of what was certified last on the object itself, so that it is known that there was something.
CERTIFIED = "sscc_certified"


@dataclass(frozen=True)
class Certified:
    """Certificates, and how their triangles belong to the mesh."""

    certificates: sscc.Certificates
    faces: np.ndarray  #: (F, 3) vertices of the triangles
    polygons: np.ndarray  #: (F) of which polygon each is


@dataclass(frozen=True)
class Status:
    """What is said of an object: ``kind`` is free, colliding, changed, uncertified or unsupported."""

    kind: str
    text: str
    polygons: np.ndarray = field(default_factory=lambda: np.empty(0, np.int64))  #: colliding ones, ascending
    corners: np.ndarray = field(default_factory=lambda: np.empty((0, 3)))  #: of colliding triangles, three each


_known: OrderedDict[tuple[bytes, bool], Certified] = OrderedDict()


def forget() -> None:
    """Forgets all certificates."""
    _known.clear()


def certify(obj: bpy.types.Object, ignore_rest: bool, progress: object = False) -> Certified:
    """Certifies the shape of an object as it is now. Raises `Unsupported`, or what sscc refuses."""
    shapes.check(obj)
    shape = shapes.read(obj)
    faces, polygons = shapes.triangles(obj, shape)
    model = sscc.Model(shape.basis, faces, shape.modes())
    certificates = model.certify(ignore_rest=ignore_rest, progress=progress)
    certified = Certified(certificates, faces, polygons)
    fingerprint = shape.fingerprint()
    _known[fingerprint, ignore_rest] = certified
    while len(_known) > REMEMBERED:
        _known.popitem(last=False)
    obj[CERTIFIED] = fingerprint.hex()
    return certified


def status(obj: bpy.types.Object | None, ignore_rest: bool) -> Status:
    """What may be said of an object now."""
    try:
        shapes.check(obj)
        shape = shapes.read(obj)
    except Unsupported as reason:
        return Status("unsupported", str(reason))
    certified = _known.get((shape.fingerprint(), ignore_rest))
    if certified is None:
        if CERTIFIED in obj:
            return Status("changed", "changed since it was certified, or not in this session: certify again")
        return Status("uncertified", "not certified yet")
    _known.move_to_end((shape.fingerprint(), ignore_rest))
    certificates = certified.certificates
    try:
        q = shapes.values(obj)
        pairs = certificates.check(q).pairs
    except ValueError as refusal:
        return Status("unsupported", str(refusal))
    ignored = len(certificates.ignored)
    beside = f", apart from {ignored} pairs that collide in the basis" if ignored else ""
    if len(pairs) == 0:
        return Status("free", f"free (proven){beside}")
    triangles = np.unique(pairs)
    polygons = np.unique(certified.polygons[triangles])
    corners = certificates.model.positions(q)[certified.faces[triangles].reshape(-1)]
    text = f"{len(polygons)} faces collide ({len(pairs)} pairs of triangles){beside}"
    return Status("colliding", text, polygons, corners)
