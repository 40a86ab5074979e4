"""Certificates by fingerprint, and the status of an object.

A fingerprint covers the content of mesh and keys. Each status reads the content again and looks up its certificates by
fingerprint. So a status never belongs to another shape, and after an undo the certificates of the shape are found again,
if they are among the last that were used.
"""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass

import bpy
import numpy as np
import sscc

from . import shape as shapes
from .shape import Unsupported
from .status import Status, colliding

#: Certificates of at most this many shapes are kept.
MAX_CERTIFIED = 8

#: Property of an object: the fingerprint that was certified last. Uncertified objects have no such property.
CERTIFIED = "sscc_certified"


@dataclass(frozen=True)
class Certified:
    """Certificates, and the vertices and polygons of their triangles."""

    certificates: sscc.Certificates
    faces: np.ndarray  #: (F, 3) vertex numbers of the triangles
    polygons: np.ndarray  #: (F) polygon of each triangle


_known: OrderedDict[tuple[bytes, bool], Certified] = OrderedDict()


def forget() -> None:
    """Forgets all certificates."""
    _known.clear()


def certify(obj: bpy.types.Object, ignore_rest: bool, progress: object = False) -> Certified:
    """Certifies the current shape of an object. Raises `Unsupported` and the errors of `sscc.Model` and `certify`."""
    shapes.check(obj)
    shape = shapes.read(obj)
    faces, polygons = shapes.triangles(obj, shape)
    model = sscc.Model(shape.basis, faces, shape.modes())
    certificates = model.certify(ignore_rest=ignore_rest, progress=progress)
    certified = Certified(certificates, faces, polygons)
    fingerprint = shape.fingerprint()
    _known[fingerprint, ignore_rest] = certified
    while len(_known) > MAX_CERTIFIED:
        _known.popitem(last=False)
    obj[CERTIFIED] = fingerprint.hex()
    return certified


def status(obj: bpy.types.Object | None, ignore_rest: bool) -> Status:
    """Returns the status of an object at the current values of its keys."""
    try:
        shapes.check(obj)
        shape = shapes.read(obj)
    except Unsupported as reason:
        return Status("unsupported", str(reason))
    certified = _known.get((shape.fingerprint(), ignore_rest))
    if certified is None:
        if CERTIFIED in obj:
            return Status("changed", "changed, or certified in another session: certify again")
        return Status("uncertified", "not certified yet: press Certify")
    _known.move_to_end((shape.fingerprint(), ignore_rest))
    certificates = certified.certificates
    try:
        q = shapes.values(obj)
        pairs = certificates.check(q).pairs
    except ValueError as refusal:
        return Status("unsupported", str(refusal))
    ignored = len(certificates.ignored)
    ignoring = f", apart from {ignored} pairs that collide in the basis" if ignored else ""
    if len(pairs) == 0:
        return Status("free", f"free (proven){ignoring}")
    found = colliding(pairs, certified.polygons, certificates.model.positions(q), certified.faces)
    return Status(found.kind, found.text + ignoring, found.polygons, found.corners)
