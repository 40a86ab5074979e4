"""``repr`` of every public class is one short line."""

from __future__ import annotations

import inspect
from pathlib import Path

import numpy as np
import pytest

import sscc
from scenes import character
from shapes import samples, torus, two_triangles

#: Maximum length: a longer line wraps more than once in a usual terminal.
LIMIT = 200


def instances(
    model: sscc.Model, certs: sscc.Certificates, scene: sscc.Scene
) -> dict[str, list[object]]:
    """Returns small, large and unusual objects of each class."""
    vertices, faces, modes = torus(24, 12, 6)
    draws = samples(500, 6, 0.4)
    # Draws far from free configurations take long to resolve.
    near = 0.4 * draws
    assert certs.check_many(near).colliding.any()
    far = draws[certs.check_many(draws).colliding][0]
    detector = sscc.Detector(faces, vertices)
    crossing = model.positions(far)
    touching = sscc.Model(*two_triangles()).certify(center=[-1.0])
    huge = sscc.Model(vertices, faces, modes, metric=np.full(6, 1e40)).certify()
    long_name = "left_\n" + "very_" * 100 + "long"
    no_pairs = np.zeros((0, 2), np.uint32)
    return {
        "Answer": [certs.check(np.zeros(6)), certs.check(far), certs.check(far, 1), huge.check(far)],
        "Batch": [certs.check_many(draws), certs.check_many(draws[:0])],
        "BodyPenetration": [sscc.BodyPenetration(-1e-300, 1e300, 0.1, 1e-9)],
        "Certificates": [certs, touching, huge],
        "Curve": [*detector.check(crossing).curves(), sscc.Curve(np.zeros((1, 3)), no_pairs, False)],
        "Detector": [detector, sscc.Detector(faces)],
        "DetectorAnswer": [detector.check(vertices), detector.check(crossing), detector.check(crossing, 1)],
        "DetectorBatch": [detector.check_many([vertices, crossing] * 50)],
        "DetectorImpacts": [detector.continuous(vertices, vertices), detector.continuous(vertices, crossing)],
        "FreeSamples": [certs.free_samples(near), certs.free_samples(near[:0])],
        "Hierarchy": [certs.hierarchy],
        "Impacts": [certs.continuous(np.zeros(6), np.zeros(6)), certs.continuous(np.zeros(6), far)],
        "Interval": [sscc.Interval(-1e-300, 1e300, None, 0.1, False, 10**9, 0.2, 0.3)],
        "Intervals": [
            *certs.intervals((-3.0, 3.0), samples=3),
            *touching.intervals((-1.5, 1.0), samples=3),
            sscc.Intervals(66, long_name, -1e-300, 1e300, [], np.zeros((2, 3))),
        ],
        "KineticQuery": [certs.kinetic()],
        "Model": [model, sscc.Model(*two_triangles())],
        "Resolved": [
            certs.resolve(far),
            certs.resolve(np.zeros(6)),
            touching.resolve([-1.0], all=True),
            sscc.Resolved(True, np.zeros(5000), 1e-300, 1e300),
        ],
        "Scene": [scene],
        "SceneAnimation": [*scene.animations, sscc.SceneAnimation(None, 0.0)],
        "SceneAnswer": [*scene.check("wave", times=[0.0, 0.5]), *scene.check(clearance=0.5)],
        "SceneNode": [*scene.nodes],
        "Simulation": [
            sscc.Simulation(
                {"scene": long_name, "steps": 10**9, "colliding_steps": 3}, Path("/" + "folder/" * 200), [Path("a")] * 9
            )
        ],
        "Sweep": [
            *certs.sweep((-3.0, 3.0)),
            *touching.sweep((-1.0, 1.0)),
            sscc.Sweep(66, long_name, -1e-300, 1e300, 0.1, 0.2, no_pairs, "a grazing contact\n"),
            sscc.Sweep(66, long_name, 0.0, 1.0, 0.1, None, no_pairs, "nothing is proven beyond"),
            sscc.Sweep(66, long_name, 0.0, 1.0, None, 0.0, no_pairs, "it collides at the start"),
        ],
        "UsdMesh": [sscc.UsdMesh(long_name, np.zeros((0, 3), np.uint32), np.zeros((1, 0, 3)), np.zeros(1))],
    }


def test_each_class_has_a_representation_of_one_line(
    model: sscc.Model, certs: sscc.Certificates, tmp_path: Path
) -> None:
    classes = {name for name in sscc.__all__ if inspect.isclass(getattr(sscc, name))}
    made = instances(model, certs, sscc.Scene.load(character(tmp_path)))
    assert classes == set(made), "each public class has instances here"
    for name, objects in made.items():
        for thing in objects:
            assert type(thing) is getattr(sscc, name)
            text = repr(thing)
            assert text.startswith(f"<sscc.{name}: ") and text.endswith(">"), text
            assert len(text) < LIMIT and text.isprintable(), text


def test_representations_show_the_main_numbers(model: sscc.Model, certs: sscc.Certificates) -> None:
    assert repr(model) == "<sscc.Model: 576 triangles, 288 vertices, 6 modes>"
    assert repr(certs).startswith("<sscc.Certificates: root radius 0.")
    assert repr(certs.check(np.zeros(6))) == "<sscc.Answer: free, norm 0>"
    assert repr(certs.check_many(np.zeros((2, 6)))) == "<sscc.Batch: 2 answers, 0 colliding>"
    assert repr(certs.continuous(np.zeros(6), np.zeros(6))) == "<sscc.Impacts: free from q0 to q1>"
    assert repr(certs.kinetic()) == "<sscc.KineticQuery: 576 triangles, 6 modes>"
    assert repr(certs.hierarchy).startswith("<sscc.Hierarchy: ")
    # A small norm is not 0.
    assert "norm 0>" not in repr(certs.check(np.full(6, 1e-9)))

    touching = sscc.Model(*two_triangles()).certify()
    assert repr(touching.check([-1.0])) == "<sscc.Answer: colliding, 1 pair, norm 1.000>"
    draws = [[-1.0], [0.5], [1.0]]
    drawn = "2 free configurations from 3 draws (2 of them free), q of shape (2, 1)"
    assert repr(touching.free_samples(draws, resolve=False)) == f"<sscc.FreeSamples: {drawn}>"
    assert repr(touching.resolve([0.5])) == "<sscc.Resolved: free as it is, q of shape (1,)>"
    assert repr(touching.resolve([-1.0])).startswith("<sscc.Resolved: resolved, change ")
    up, down = touching.sweep((-2.0, 2.0))
    assert repr(up) == "<sscc.Sweep: mode 0 from 0 to 2: free>"
    assert repr(down) == "<sscc.Sweep: mode 0 from 0 to -2: touches at -1, 1 pair>"
    (found,) = touching.intervals((-2.0, 2.0))
    assert repr(found) == "<sscc.Intervals: mode 0 from -2 to 2: 1 interval>"
    assert repr(found.intervals[0]) == "<sscc.Interval: from -1 to -1: up to 1 pair, depth 0 at -1>"
    named = sscc.Sweep(3, "smile", 0.0, 1.0, 1.0, None, np.zeros((0, 2), np.uint32), None)
    assert repr(named) == "<sscc.Sweep: mode 3 'smile' from 0 to 1: free>"


def test_libraries_have_short_representations(certs: sscc.Certificates) -> None:
    batch = pytest.importorskip("sscc.batch", exc_type=ImportError)
    library = batch.Library({"a": certs}, {"b" * 500: ValueError("x" * 500)})
    assert repr(library) == "<sscc.batch.Library: 1 model certified, 1 failed>"
