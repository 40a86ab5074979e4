"""Error messages: one line that names the argument and the place."""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sscc
from shapes import torus, two_triangles

V, F, U = torus(8, 5, 3)
#: Whether long double has more digits than double.
LONG = np.dtype(np.longdouble).itemsize > 8


def put(array: Any, place: Any, value: Any) -> Any:
    changed = array.copy()
    changed[place] = value
    return changed


def model(**changed: Any) -> sscc.Model:
    return sscc.Model(**{"vertices": V, "faces": F, "modes": U, **changed})


MODELS: list[tuple[dict[str, Any], type[Exception], str]] = [
    ({"vertices": V[:, :2]}, ValueError, "vertices has shape [40, 2]: (V, 3) was expected"),
    ({"vertices": V.ravel()}, ValueError, "vertices has shape [120]: (V, 3) was expected"),
    ({"vertices": put(V, (7, 1), np.nan)}, ValueError, "vertices: vertex 7 (counted from 0) has the position"),
    ({"vertices": put(V, (7, 1), 1e80)}, ValueError, "vertices: vertex 7 (counted from 0)"),
    ({"vertices": V.astype(complex)}, TypeError, "vertices is an array of complex128: float64, float32 or"),
    ({"vertices": V.astype(object)}, TypeError, "vertices is a ndarray: an array of numbers was expected"),
    ({"vertices": V.astype(bool)}, TypeError, "vertices is an array of bool"),
    *([({"vertices": V.astype(np.longdouble)}, TypeError, f"vertices is an array of {np.dtype(np.longdouble)}")] if LONG else []),
    ({"vertices": "x.obj"}, TypeError, "vertices is a str: an array of numbers was expected"),
    ({"vertices": None}, TypeError, "vertices is a NoneType: an array of numbers was expected"),
    ({"vertices": [[1, 2, 3], [1, 2]]}, ValueError, "vertices: an array of numbers was expected: "),
    ({"vertices": np.ma.masked_array(V)}, TypeError, "vertices is a masked array: fill it first, as by vert"),
    ({"vertices": V[:0]}, ValueError, "faces[0] names vertex"),
    ({"faces": F[:, :2]}, ValueError, "faces has shape [80, 2]: (F, 3) was expected"),
    ({"faces": F.astype(float)}, TypeError, "faces is an array of float64: integers were expected"),
    ({"faces": put(F, (5, 1), 40)}, ValueError, "faces[5] names vertex 40: vertices has 40, counted from 0"),
    ({"faces": put(F, (5, 1), -1)}, ValueError, "faces[5] names vertex -1: vertices has 40"),
    ({"faces": put(F, (5, 1), 2**40)}, ValueError, f"faces[5] names vertex {2**40}: vertices has 40"),
    ({"faces": F[:0]}, ValueError, "faces: the mesh has no triangles"),
    ({"faces": np.full((1, 3), 2**63, np.uint64)}, ValueError, f"faces: {2**63} is too large"),
    ({"modes": U[:-1]}, ValueError, "modes: the modes are for 39 vertices, the mesh has 40"),
    ({"modes": U.reshape(-1, 3).T}, ValueError, "modes: shape [3, 120] has the modes in rows: transpose it"),
    ({"modes": U[:, :, :0]}, ValueError, "modes: the array of shape [40, 3, 0] is empty"),
    ({"modes": put(U, (7, 1, 2), np.inf)}, ValueError, "modes: mode 2 of vertex 7 (both counted from 0)"),
    ({"modes": put(U, (7, 1, 2), 0).astype("c8")}, TypeError, "modes is an array of complex64"),
    ({"metric": "stiff"}, ValueError, "metric is 'stiff': 'energy', 'displacement'"),
    ({"metric": "energy"}, ValueError, "metric: the model's own is 'displacement', not 'energy'"),
    ({"metric": [1, 1]}, ValueError, "metric has shape [2]: (3,) or (3, 3) was expected"),
    ({"metric": [1, 0, 1]}, ValueError, "metric: metric weight 1 (counted from 0) is 0"),
    ({"metric": [1, 1e-300, 1]}, ValueError, "metric: the modes divided by the metric's scales reach"),
    ({"metric": -np.eye(3)}, ValueError, "metric: the metric's matrix cannot be used"),
    ({"metric": np.triu(np.ones((3, 3)))}, ValueError, "metric: the metric's matrix cannot be used"),
]


@pytest.mark.parametrize(("changed", "error", "message"), MODELS, ids=[m for _, _, m in MODELS])
def test_invalid_models_are_refused(changed: dict[str, Any], error: type[Exception], message: str) -> None:
    with pytest.raises(error, match="^" + re.escape(message)) as raised:
        model(**changed)
    assert "\n" not in str(raised.value) or "inhomogeneous" in str(raised.value)


OPTIONS: list[tuple[dict[str, Any], type[Exception], str]] = [
    ({"threads": -1}, ValueError, "threads is -1: a whole number from 1 to 1024 was expected"),
    ({"threads": 0}, ValueError, "threads is 0"),
    ({"threads": 10**30}, ValueError, "threads is 1000000000000000000000000000000: a whole number from 1"),
    ({"threads": 1.0}, TypeError, "threads is a float: a whole number from 1 to 1024 was expected"),
    ({"threads": True}, TypeError, "threads is a bool"),
    ({"epsilon": 0}, ValueError, "epsilon is 0: a number between 0 and 1 was expected"),
    ({"epsilon": float("nan")}, ValueError, "epsilon is NaN"),
    ({"epsilon": "x"}, TypeError, "epsilon is a str: a number was expected"),
    ({"epsilon": 10**400}, ValueError, "epsilon is beyond the range of a float64"),
    ({"center": [0, 0]}, ValueError, "center has 2 entries, the model has 3 modes"),
    ({"center": [0, np.nan, 0]}, ValueError, "center[1] is NaN: every entry must be finite"),
    ({"center": [0, 1e200, 0]}, ValueError, "center moves vertices beyond 2^200 (about 1.6e60): scale it or the model down"),
    ({"center": [[0, 0, 0]]}, ValueError, "center has shape [1, 3]: one configuration was expected"),
    ({"scheme": "best"}, ValueError, "scheme is 'best': 'full' or 'paper' was expected"),
    ({"scheme": 1}, TypeError, "scheme is a int: 'full' or 'paper' was expected"),
    ({"scheme": "paper", "budget": 1}, ValueError, "scheme 'paper' stores no pair tree: leave budget out"),
    ({"budget": -1}, ValueError, "budget is -1"),
    ({"scheme": "paper", "reach": 2}, ValueError, "scheme 'paper' ends radii at the global radius: leave reach out"),
    ({"reach": 0.5}, ValueError, "reach is 0.5: a finite number of at least 1 was expected"),
    ({"reach": np.inf}, ValueError, "reach is inf: a finite number of at least 1 was expected"),
    ({"reach": "far"}, TypeError, "reach is a str: a number was expected"),
    ({"neighbours": "all"}, ValueError, "neighbours is 'all': 'exclude' or 'include-one-vertex' or 'include-folded'"),
    ({"neighbours": "include-folded"}, ValueError, "neighbours: include-folded is for discrete queries of meshes"),
    ({"weld": "on"}, TypeError, "weld is a str: True or False was expected"),
    ({"ignore_rest": -1}, ValueError, "ignore_rest is -1: a whole number from 0 to 4294967295 was expected"),
    ({"ignore_rest": "lips"}, TypeError, "ignore_rest is a str"),
    ({"max_exceptions": -1}, ValueError, "max_exceptions is -1: a whole number of at least 0 was expected"),
    ({"metric": "energy"}, ValueError, "metric: the model's own is 'displacement', not 'energy'"),
    ({"progress": 3}, TypeError, "progress is a int: a function of one number"),
]


@pytest.mark.parametrize(("options", "error", "message"), OPTIONS, ids=[m for _, _, m in OPTIONS])
def test_invalid_options_are_refused(options: dict[str, Any], error: type[Exception], message: str) -> None:
    with pytest.raises(error, match="^" + re.escape(message)):
        model().certify(**options)


def test_unknown_and_positional_options_are_refused() -> None:
    with pytest.raises(TypeError, match="bugdet"):
        model().certify(bugdet=3)  # type: ignore[call-arg]
    with pytest.raises(TypeError, match="positional"):
        model().certify(0.1)  # type: ignore[call-arg]


QS: list[tuple[Any, type[Exception], str]] = [
    ([1, 2], ValueError, "{} has 2 entries, the model has 6 modes"),
    ([0, 0, np.nan, 0, 0, 0], ValueError, "{}[2] is NaN: every entry must be finite"),
    ([0, 0, 0, 0, 0, -np.inf], ValueError, "{}[5] is -inf: every entry must be finite"),
    ([1e200, 0, 0, 0, 0, 0], ValueError, "{} moves vertices beyond 2^200 (about 1.6e60)"),
    (np.zeros((2, 6)), ValueError, "{} has shape [2, 6]: one configuration was expected"),
    (1.0, ValueError, "{} has shape []: one configuration was expected"),
    (None, TypeError, "{} is a NoneType: an array of numbers was expected"),
    (["a"] * 6, TypeError, "{} is a list: an array of numbers was expected"),
    (np.ma.masked_array(np.zeros(6), mask=np.arange(6) == 0), TypeError, "{} is a masked array: fill it first"),
    ([2**64, 0, 0, 0, 0, 0], ValueError, "{} has an integer of more than 64 bits: integers are exact up to 2^53"),
    ([-(10**5000), 0, 0, 0, 0, 0], ValueError, "{} has an integer of more than 64 bits"),
    (np.zeros(6, "M8[s]"), TypeError, "{} is a ndarray: an array of numbers was expected"),
    ([2**53 + 1, 0, 0, 0, 0, 0], ValueError, "{}: the integer 9007199254740993 is beyond 2^53"),
    ([-(2**63), 0, 0, 0, 0, 0], ValueError, "{}: the integer -9223372036854775808 is beyond 2^53"),
]


@pytest.mark.parametrize(("q", "error", "message"), QS, ids=[m for _, _, m in QS])
def test_invalid_q_are_refused(certs: sscc.Certificates, q: Any, error: type[Exception], message: str) -> None:
    good = np.zeros(6)
    calls: dict[str, list[Callable[[], object]]] = {
        "q": [
            lambda: certs.check(q),
            lambda: certs.safe_scale(q),
            lambda: certs.clamp(q) if "beyond 2^200" not in message else certs.check(q),
            lambda: certs.norm(q),
            lambda: certs.model.positions(q),
            lambda: certs.kinetic().check(q),
        ],
        "q0": [lambda: certs.continuous(q, good), lambda: certs.continuous(q, q)],
        "q1": [lambda: certs.continuous(good, q)],
    }
    for name, named in calls.items():
        for call in named:
            with pytest.raises(error, match="^" + re.escape(message.format(name))):
                call()
    # An error does not change the state of the query.
    assert not certs.check(good).colliding


def test_errors_of_batches_name_the_row(certs: sscc.Certificates) -> None:
    rows = np.zeros((100, 6))
    rows[40, 3], rows[70, 1] = np.nan, np.inf
    for threads in (1, 2):
        with pytest.raises(ValueError, match=re.escape("Q[40][3] is NaN: every entry must be finite")):
            certs.check_many(rows, threads=threads)
    with pytest.raises(ValueError, match=re.escape("Q has shape [100, 5]: (n, 6) was expected")):
        certs.check_many(rows[:, :5])
    with pytest.raises(ValueError, match=re.escape("Q has shape [6]: (n, 6) was expected; for one q use check")):
        certs.check_many(rows[0])
    with pytest.raises(TypeError, match="Q is a masked array"):
        certs.check_many(np.ma.masked_array(rows))
    masked = np.ma.masked_array(rows[0], mask=np.arange(6) == 2)
    nested: list[Any] = [[rows[0], masked], (masked,), [tuple(rows[0]), masked], [[*rows[0][:5], masked[2]]]]
    for many in nested:
        with pytest.raises(TypeError, match="masked"):
            certs.check_many(many)
    with pytest.raises(TypeError, match="modes is a masked array: fill it first"):
        sscc.Model(V, F, [[masked[:1]] * 3] * len(V))
    with pytest.raises(ValueError, match="threads is -1"):
        certs.check_many(rows, threads=-1)


def test_invalid_limits_and_node_numbers_are_refused(certs: sscc.Certificates) -> None:
    limits: list[Any] = [0, -3, 1.5, "1", True]
    for limit in limits:
        error = ValueError if type(limit) is int else TypeError
        with pytest.raises(error, match="^limit is "):
            certs.check(np.zeros(6), limit)
        with pytest.raises(error, match="^limit is "):
            certs.check_many(np.zeros((2, 6)), limit)
    assert certs.check(np.full(6, 2.0), np.int8(3)).count == 3
    with pytest.raises(ValueError, match="^node is 100000: a whole number from 0 to "):
        certs.radius(100000)
    with pytest.raises(ValueError, match="^node is -1"):
        certs.radius(-1)


def test_arrays_beyond_memory_raise_memory_error(certs: sscc.Certificates) -> None:
    with pytest.raises(MemoryError):
        certs.check_many(np.broadcast_to(np.zeros(6), (10**14, 6)))
    with pytest.raises(MemoryError):
        model(modes=np.broadcast_to(0.0, (40, 3, 10**12)))
    with pytest.raises(MemoryError):
        model(vertices=np.broadcast_to(0.0, (10**13, 3)))


@pytest.mark.skipif(os.name == "nt", reason="names of files cannot have line breaks")
def test_paths_in_messages_are_on_one_line(tmp_path: Path, certs: sscc.Certificates) -> None:
    path = tmp_path / "a\nb.sscc.safetensors"
    certs.save(path)
    with pytest.raises(ValueError, match=r"a\\nb\.sscc\.safetensors: the certificates are of another model") as error:
        sscc.Certificates.load(path, sscc.Model(*two_triangles()))
    assert "\n" not in str(error.value)


def test_errors_of_files_name_the_file(tmp_path: Path, certs: sscc.Certificates) -> None:
    with pytest.raises(FileNotFoundError, match=r"a\.obj: not found$"):
        sscc.Model.load(tmp_path / "a.obj")
    mesh = tmp_path / "mesh.obj"
    mesh.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    with pytest.raises(ValueError, match=r"mesh\.obj: a mesh has no modes: add modes FILE, or"):
        sscc.Model.load(mesh)
    with pytest.raises(ValueError, match=r"only a glTF file can have several meshes: leave out mesh_name$"):
        sscc.Model.load(mesh, mesh_name="a")
    with pytest.raises(OSError, match="is a directory, a file was expected"):
        sscc.Certificates.load(tmp_path, certs.model)
    with pytest.raises(TypeError, match="^path is a int: the name of a file was expected"):
        sscc.Model.load(3)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"the name of the file must end in \.model\.safetensors$"):
        certs.model.save(tmp_path / "a.safetensors")
    with pytest.raises(ValueError, match=r"the name of the file must end in \.sscc\.safetensors$"):
        certs.save(tmp_path / "a.model.safetensors")
    with pytest.raises(OSError, match="cannot be written"):
        certs.save(tmp_path / "missing" / "a.sscc.safetensors")
    certs.save(tmp_path / "a.sscc.safetensors")
    other = sscc.Model(*two_triangles())
    with pytest.raises(ValueError, match=r"a\.sscc\.safetensors: the certificates are of another model"):
        sscc.Certificates.load(tmp_path / "a.sscc.safetensors", other)
    damaged = bytearray((tmp_path / "a.sscc.safetensors").read_bytes())
    damaged[-9] ^= 1
    (tmp_path / "b.sscc.safetensors").write_bytes(damaged)
    with pytest.raises(ValueError, match=r"b\.sscc\.safetensors: "):
        sscc.Certificates.load(tmp_path / "b.sscc.safetensors", certs.model)
