"""The testers of other projects: how each is prepared for a mesh, and asked whether the mesh meets itself."""

from __future__ import annotations

import importlib.metadata
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

import compiled

Array = Any
Call = Callable[[Any], Any]


@dataclass
class Tester:
    """One way to ask one package."""

    package: str  # the distribution on PyPI, or none
    licence: str
    arithmetic: str  # of its answer, as its documentation says: "exact" or "floating point"
    prepare: Callable[[Array, Array], Any]  # from positions (V, 3) and faces (F, 3)
    every: Call | None = None  # all pairs (n, 2), or all faces (n,)
    first: Call | None = None  # one pair; whether there is one
    yes_no: Call | None = None  # whether there is one
    lists_faces: bool = False
    own_version: str = ""  # without a distribution

    def version(self) -> str:
        return self.own_version or importlib.metadata.version(self.package)


def arrays(x: Array, f: Array) -> tuple[Array, Array]:
    return x, f


# sscc


def of_sscc_call() -> Tester:
    import sscc

    return Tester("sscc", "MIT or Apache-2.0", "exact", arrays, lambda a: sscc.self_intersections(*a))


def of_sscc_detector() -> Tester:
    import sscc

    def prepare(x: Array, f: Array) -> Any:
        return sscc.Detector(f, x), x

    def first(a: Any) -> bool:
        return bool(a[0].check(a[1], first=True).colliding)

    return Tester(
        "sscc", "MIT or Apache-2.0", "exact", prepare, lambda a: a[0].check(a[1]).pairs, first, first
    )


# libigl and CGAL


def of_igl_predicates() -> Tester:
    from igl.predicates import find_self_intersections as find

    def first(a: Any) -> bool:
        return bool(find(*a, first_only=True)[0])

    return Tester("libigl", "MPL-2.0", "exact", arrays, lambda a: find(*a)[1], first, first)


def of_igl_constructions() -> Tester:
    from igl.copyleft.cgal import remesh_self_intersections as remesh

    def first(a: Any) -> bool:
        return len(remesh(*a, detect_only=True, first_only=True)[2]) > 0

    def every(a: Any) -> Array:
        return remesh(*a, detect_only=True)[2]

    return Tester("libigl", "GPL-3.0 (copyleft)", "exact", arrays, every, first, first)


def of_cgal() -> Tester:
    from CGAL import CGAL_Polygon_mesh_processing as processing
    from CGAL.CGAL_Kernel import Point_3
    from CGAL.CGAL_Polyhedron_3 import Polyhedron_3

    def prepare(x: Array, f: Array) -> Any:
        used, corners = np.unique(f, return_inverse=True)
        points, polygons = processing.Point_3_Vector(), processing.Polygon_Vector()
        for point in x[used].tolist():
            points.append(Point_3(*point))
        for triangle in corners.reshape(-1, 3).tolist():
            polygons.append(processing.Int_Vector(triangle))
        if not processing.orient_polygon_soup(points, polygons):
            raise ValueError("not manifold")
        polyhedron = Polyhedron_3()
        processing.polygon_soup_to_polygon_mesh(points, polygons, polyhedron)
        for number, facet in enumerate(polyhedron.facets()):
            facet.set_id(number)
        return polyhedron

    def every(polyhedron: Any) -> Array:
        found: list[Any] = []
        processing.self_intersections(polyhedron, found)
        return np.array([(pair.first.id(), pair.second.id()) for pair in found])

    def yes_no(polyhedron: Any) -> bool:
        return bool(processing.does_self_intersect(polyhedron))

    return Tester("cgal", "GPL-3.0 or commercial", "exact", prepare, every, None, yes_no)


# testers in floating-point arithmetic


def of_fcl() -> Tester:
    """The engine of `trimesh.collision`, which compares objects only with each other."""
    import fcl

    def prepare(x: Array, f: Array) -> Any:
        model = fcl.BVHModel()
        model.beginModel(len(x), len(f))
        model.addSubModel(x, f)
        model.endModel()
        return fcl.CollisionObject(model, fcl.Transform())

    def every(thing: Any) -> Array:
        result = fcl.CollisionResult()
        request = fcl.CollisionRequest(num_max_contacts=100_000_000, enable_contact=True)
        fcl.collide(thing, thing, request, result)
        return np.array([(contact.b1, contact.b2) for contact in result.contacts])

    return Tester("python-fcl", "BSD-3-Clause", "floating point", prepare, every)


def of_open3d() -> Tester:
    import open3d

    def prepare(x: Array, f: Array) -> Any:
        geometry, utility = open3d.geometry, open3d.utility
        return geometry.TriangleMesh(utility.Vector3dVector(x), utility.Vector3iVector(f.astype(np.int32)))

    def every(mesh: Any) -> Array:
        return np.asarray(mesh.get_self_intersecting_triangles())

    return Tester("open3d", "MIT", "floating point", prepare, every, None, lambda mesh: mesh.is_self_intersecting())


def of_pymeshlab() -> Tester:
    import pymeshlab

    def prepare(x: Array, f: Array) -> Any:
        meshes = pymeshlab.MeshSet()
        meshes.add_mesh(pymeshlab.Mesh(x, f.astype(np.int32)))
        return meshes

    def every(meshes: Any) -> Array:
        meshes.apply_filter("compute_selection_by_self_intersections_per_face")
        return np.flatnonzero(meshes.current_mesh().face_selection_array())

    return Tester("pymeshlab", "GPL-3.0", "floating point", prepare, every, lists_faces=True)


def of_meshlib() -> Tester:
    from meshlib import mrmeshnumpy, mrmeshpy

    def prepare(x: Array, f: Array) -> Any:
        return mrmeshnumpy.meshFromFacesVerts(f.astype(np.int32), x)

    def every(mesh: Any) -> Array:
        found = mrmeshpy.findSelfCollidingTriangles(mrmeshpy.MeshPart(mesh), touchIsIntersection=True)
        return np.array([(pair.aFace.get(), pair.bFace.get()) for pair in found])

    def yes_no(mesh: Any) -> bool:
        return bool(mrmeshpy.findSelfCollidingTriangles(mrmeshpy.MeshPart(mesh), None, touchIsIntersection=True))

    return Tester("meshlib", "non-commercial or commercial", "floating point", prepare, every, None, yes_no)


def of_trueform() -> Tester:
    import trueform

    def prepare(x: Array, f: Array) -> Any:
        return trueform.Mesh(f.astype(np.int32), x)

    return Tester(
        "trueform",
        "PolyForm Noncommercial",
        "exact",
        prepare,
        None,
        None,
        lambda mesh: trueform.has_self_intersections(mesh),
    )


def of_trueform_gather() -> Tester:
    """Any two primitives of two forms, here of a mesh with itself: neighbours are listed as well."""
    import trueform

    def every(mesh: Any) -> Array:
        return trueform.gather_intersecting_ids(mesh, mesh)

    tester = of_trueform()
    return Tester("trueform", tester.licence, "floating point", tester.prepare, every)


def of_ipctk() -> Tester:
    import ipctk

    def prepare(x: Array, f: Array) -> Any:
        x = np.asfortranarray(x)
        return ipctk.CollisionMesh(x, ipctk.edges(f.astype(np.int32)), f.astype(np.int32)), x

    def yes_no(a: Any) -> bool:
        return bool(ipctk.has_intersections(a[0], a[1]))

    return Tester("ipctk", "MIT", "floating point", prepare, None, None, yes_no)


# compiled from this folder


def of_embree() -> Tester:
    """Candidates by `rtcCollide`, which has no test of triangles: CGAL's exact predicates decide."""
    library = compiled.embree()

    class Mesh:
        def __init__(self, x: Array, f: Array) -> None:
            self.arrays = np.ascontiguousarray(x, np.float64), np.ascontiguousarray(f, np.int64)
            x, f = self.arrays
            self.handle = library.peer_make(x.ctypes.data, f.ctypes.data, len(f))

        def collide(self, first_only: bool) -> int:
            count: int = library.peer_collide(self.handle, int(first_only))
            if count < 0:
                raise ValueError(f"error {-count} of Embree")
            return count

        def __del__(self) -> None:
            library.peer_free(self.handle)

    def every(mesh: Mesh) -> Array:
        count = mesh.collide(False)
        if count == 0:
            return np.zeros((0, 2), np.int64)
        return np.ctypeslib.as_array(library.peer_pairs(mesh.handle), (count, 2)).copy()

    def yes_no(mesh: Mesh) -> bool:
        return mesh.collide(True) > 0

    version = compiled.embree_version(library)
    return Tester("", "Apache-2.0, with CGAL's LGPL-3.0", "exact", Mesh, every, None, yes_no, own_version=version)


def of_parry(exact: bool) -> Tester:
    """A deformable `TriMesh`, whose `set_vertices` is part of each answer; GJK, or the exact test of sscc, decides."""
    module = compiled.parry()

    def prepare(x: Array, f: Array) -> Any:
        x = np.ascontiguousarray(x, np.float64)
        return module.Mesh(x, np.ascontiguousarray(f, np.uint32)), x

    def every(a: Any) -> Array:
        a[0].set_vertices(a[1])
        return a[0].all(exact)

    def first(a: Any) -> bool:
        a[0].set_vertices(a[1])
        return bool(a[0].any(exact))

    arithmetic = "exact" if exact else "floating point"
    version = compiled.parry_version()
    return Tester("", "Apache-2.0", arithmetic, prepare, every, first, first, own_version=version)


TESTERS: dict[str, Callable[[], Tester]] = {
    "sscc, one call": of_sscc_call,
    "sscc, Detector": of_sscc_detector,
    "libigl, predicates": of_igl_predicates,
    "libigl, CGAL's kernel": of_igl_constructions,
    "CGAL": of_cgal,
    "trueform, yes or no": of_trueform,
    "trueform, all ids": of_trueform_gather,
    "Embree, CGAL's test": of_embree,
    "parry, exact test of sscc": lambda: of_parry(True),
    "parry, its own test": lambda: of_parry(False),
    "MeshLib": of_meshlib,
    "IPC Toolkit": of_ipctk,
    "FCL (trimesh)": of_fcl,
    "Open3D": of_open3d,
    "MeshLab": of_pymeshlab,
}
