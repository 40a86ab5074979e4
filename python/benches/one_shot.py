"""One-shot self-intersections: `sscc.self_intersections`, its BVH built in each call, and exact peers, on one thread.

Usage: python benches/one_shot.py [--models DIR] [--repetitions N] [MESH ...]

MESH: more meshes (OBJ, PLY, OFF, STL), such as the `spring.obj` that `sscc demo --out DIR` writes. Build the package in
release mode first (``maturin develop --release``). Peers, where they are installed:

- libigl, constructions: `igl.copyleft.cgal.remesh_self_intersections(..., detect_only=True)`, CGAL's exact kernel.
- libigl, predicates: `igl.predicates.find_self_intersections`, with Shewchuk's predicates.
- CGAL: `CGAL_Polygon_mesh_processing.self_intersections` (``pip install cgal``), for manifold meshes. Its polyhedron is
  built before the timed call, because Python builds it vertex by vertex.

All run in one process, one after the other in each repetition. The table has medians, and the time of each peer as a
multiple of that of sscc. An answer with other pairs is marked. libigl and CGAL omit contacts at coincident vertices.
Therefore vertices of characters that have equal positions and influences are joined first.
"""

from __future__ import annotations

import os

for variable in ("RAYON_NUM_THREADS", "OMP_NUM_THREADS", "TBB_NUM_THREADS", "IGL_NUM_THREADS"):
    os.environ[variable] = "1"

import argparse
import importlib.util
import statistics
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import sscc

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from poses import FILES, Mesh  # noqa: E402
from skinned import Character  # noqa: E402

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

#: Meshes as they are.
MESHES = ("bunny_14964", "bunny_69451", "dragon_77202")
#: Characters and moments of their first animations (s).
POSED = {"Fox": 0.5, "CesiumMan": 0.75, "RobotExpressive right hand": 0.5, "RobotExpressive left hand": 0.5}

#: A prepared call, and how to get the pairs of its result.
Call = tuple[Callable[[], Any], Callable[[Any], Any]]


def of_sscc(x: F64, f: I64) -> Call:
    return lambda: sscc.self_intersections(x, f), lambda found: found


def of_constructions(x: F64, f: I64) -> Call:
    from igl.copyleft.cgal import remesh_self_intersections

    return lambda: remesh_self_intersections(x, f, detect_only=True), lambda found: found[2]


def of_predicates(x: F64, f: I64) -> Call:
    from igl.predicates import find_self_intersections

    return lambda: find_self_intersections(x, f), lambda found: found[1]


def of_cgal(x: F64, f: I64) -> Call | None:
    from CGAL import CGAL_Polygon_mesh_processing as processing
    from CGAL.CGAL_Kernel import Point_3
    from CGAL.CGAL_Polyhedron_3 import Polyhedron_3

    used, corners = np.unique(f, return_inverse=True)
    points, polygons = processing.Point_3_Vector(), processing.Polygon_Vector()
    for point in x[used].tolist():
        points.append(Point_3(*point))
    for triangle in corners.reshape(-1, 3).tolist():
        polygons.append(processing.Int_Vector(triangle))
    if not processing.orient_polygon_soup(points, polygons):
        return None  # its polyhedra are manifold
    polyhedron = Polyhedron_3()
    processing.polygon_soup_to_polygon_mesh(points, polygons, polyhedron)
    for number, facet in enumerate(polyhedron.facets()):
        facet.set_id(number)

    def call() -> list[Any]:
        found: list[Any] = []
        processing.self_intersections(polyhedron, found)
        return found

    return call, lambda found: [(pair.first.id(), pair.second.id()) for pair in found]


PEERS: dict[str, tuple[str, Callable[[F64, I64], Call | None]]] = {
    "sscc": ("sscc", of_sscc),
    "libigl, constructions": ("igl", of_constructions),
    "libigl, predicates": ("igl", of_predicates),
    "CGAL": ("CGAL", of_cgal),
}


def meshes(models: Path | None, files: list[str]) -> Iterator[tuple[str, F64, I64]]:
    """Names, positions (V, 3) and faces (F, 3)."""
    for name in MESHES if models else ():
        assert models is not None
        mesh = Mesh(models, name)
        yield name, mesh.vertices, mesh.faces
    for name, moment in POSED.items() if models else ():
        assert models is not None
        file, place = FILES[name]
        assert isinstance(place, int)
        character = Character.load(models / file, place)
        x = character.positions(character.bones(0, moment))
        first = np.unique(character.classes, return_index=True)[1]
        yield name, x[first], character.classes[character.mesh[1]]
    for path in files:
        model = sscc.modes.polynomial(path)  # a reader of meshes
        yield Path(path).stem, model.vertices, model.faces.astype(np.int64)


def apart(pairs: Any, f: I64) -> set[tuple[int, int]]:
    """Pairs i < j of triangles without a common vertex."""
    found = np.asarray(pairs, np.int64).reshape(-1, 2)
    share = (f[found[:, 0]][:, :, None] == f[found[:, 1]][:, None, :]).any(axis=(1, 2))
    return {(min(pair), max(pair)) for pair in found[~share].tolist()}


def measure(x: F64, f: I64, peers: list[str], repetitions: int) -> tuple[dict[str, float], int, set[str]]:
    """Medians (s), the number of pairs, and the peers with other pairs than sscc."""
    prepared = {name: PEERS[name][1](x, f) for name in peers}
    calls = {name: call for name, call in prepared.items() if call is not None}
    pairs = {name: apart(pairs_of(call()), f) for name, (call, pairs_of) in calls.items()}  # warm-up
    seconds: dict[str, list[float]] = {name: [] for name in calls}
    for _ in range(repetitions):
        for name, (call, _) in calls.items():
            begin = time.perf_counter()
            call()
            seconds[name].append(time.perf_counter() - begin)
    medians = {name: statistics.median(of_name) for name, of_name in seconds.items()}
    return medians, len(pairs["sscc"]), {name for name in calls if pairs[name] != pairs["sscc"]}


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--models", default=os.environ.get("SSCC_MODELS"), help="folder of real models (SSCC_MODELS)")
    parser.add_argument("--repetitions", type=int, default=7)
    parser.add_argument("mesh", nargs="*")
    arguments = parser.parse_args()
    models = Path(arguments.models) if arguments.models else None
    if models is None and not arguments.mesh:
        parser.error("name the folder of real models by --models or SSCC_MODELS, or meshes")
    peers = [name for name, (module, _) in PEERS.items() if importlib.util.find_spec(module)]
    print("| mesh | triangles | pairs | " + " | ".join(peers) + " |")
    print("| --- " + "| ---: " * (2 + len(peers)) + "|")
    for mesh, x, f in meshes(models, arguments.mesh):
        medians, count, other = measure(x, f, peers, arguments.repetitions)
        cells = [f"{1e3 * medians['sscc']:.2f} ms"]
        for name in peers[1:]:
            ratio = f"{medians[name] / medians['sscc']:.1f}" if name in medians else "not manifold"
            cells.append(f"{ratio}{' (other pairs)' if name in other else ''}")
        print(f"| {mesh} | {len(f):,} | {count:,} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
