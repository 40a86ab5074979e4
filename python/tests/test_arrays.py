"""Arrays of any memory order, byte order and type give the right answer or a clear error."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import sscc
from shapes import samples, torus

Any64 = NDArray[Any]


def unaligned(array: Any64) -> Any64:
    """Returns the same numbers at an odd address."""
    raw = np.zeros(array.nbytes + 1, np.uint8)
    shifted = raw[1:].view(array.dtype).reshape(array.shape)
    shifted[...] = array
    assert not shifted.flags.aligned
    return shifted


def every_other(array: Any64) -> Any64:
    """Returns the same numbers with others between them, along every axis."""
    wide = np.full([2 * n for n in array.shape], 77, array.dtype)
    view = wide[tuple(slice(None, None, 2) for _ in array.shape)]
    view[...] = array
    return view


class OnlyDlpack:
    """An array of another library that has only DLPack."""

    def __init__(self, array: Any64) -> None:
        self.array = np.array(array)

    def __dlpack__(self, **options: Any) -> Any:
        return self.array.__dlpack__(**options)

    def __dlpack_device__(self) -> tuple[int, int]:
        return self.array.__dlpack_device__()


class OnlyInterface:
    """An array of another library that has only the array interface."""

    def __init__(self, array: Any64) -> None:
        self.array = array
        self.__array_interface__ = array.__array_interface__


LAYOUTS: dict[str, Callable[[Any64], Any]] = {
    "C": np.ascontiguousarray,
    "Fortran": np.asfortranarray,
    "transposed": lambda a: np.ascontiguousarray(a.T).T,
    "strided": every_other,
    "reversed": lambda a: np.ascontiguousarray(a[::-1])[::-1],
    "unaligned": unaligned,
    "big-endian": lambda a: a.astype(a.dtype.newbyteorder(">")),
    "read-only": lambda a: np.frombuffer(a.tobytes(), a.dtype).reshape(a.shape),
    "DLPack": OnlyDlpack,
    "array interface": OnlyInterface,
    "buffer": lambda a: memoryview(np.ascontiguousarray(a).data),
    "matrix or list": lambda a: np.asmatrix(a) if a.ndim == 2 else a.tolist(),
}


@pytest.mark.parametrize("layout", LAYOUTS)
def test_layouts(layout: str, certs: sscc.Certificates) -> None:
    change = LAYOUTS[layout]
    vertices, faces, modes = torus(24, 12, 6)
    for given in (modes, modes.reshape(-1, 6), np.moveaxis(modes, 2, 0)):
        model = sscc.Model(change(vertices), change(faces), change(given))
        assert np.array_equal(model.vertices, vertices) and np.array_equal(model.faces, faces)
        assert np.array_equal(model.modes, modes)
    dense = np.diag(np.arange(1.0, 7)) + np.triu(np.full((6, 6), 0.1)) + np.triu(np.full((6, 6), 0.1)).T
    expected = certs.model.certify(metric=dense).metric_factor
    assert np.array_equal(certs.model.certify(metric=change(dense)).metric_factor, expected)
    qs = samples(30, 6, 0.4)
    assert certs.check_many(change(qs)) == certs.check_many(qs)
    for q in qs:
        assert certs.check(change(q)) == certs.check(q)
        assert certs.continuous(change(q), change(q / 2)) == certs.continuous(q, q / 2)
        assert np.array_equal(certs.model.positions(change(q)), certs.model.positions(q))


@pytest.mark.parametrize("dtype", ["f8", "f4", "f2", "i1", "i2", "i4", "i8", "u1", "u2", "u4", "u8"])
def test_types(dtype: str, certs: sscc.Certificates) -> None:
    q = np.array([1, 0, 2, 1, 0, 1])
    assert certs.check(q.astype(dtype)) == certs.check(q.astype(float))
    assert certs.check_many(q[None].astype(dtype))[0] == certs.check(q.astype(float))
    vertices, faces, modes = torus(24, 12, 6)
    rounded = np.round(20 * np.abs(modes)).clip(0, 100).astype(dtype)
    assert np.array_equal(sscc.Model(vertices, faces, rounded).modes, rounded.astype(float))


def test_single_precision_is_widened_exactly(certs: sscc.Certificates) -> None:
    q = samples(1, 6, 0.4)[0].astype(np.float32)
    assert certs.norm(q) == certs.norm(q.astype(np.float64))
    assert certs.norm(q) == certs.norm([float(x) for x in q])


@pytest.mark.parametrize("dtype", ["i1", "i2", "i4", "i8", "u1", "u2", "u4", "u8"])
def test_types_of_faces(dtype: str) -> None:
    vertices, faces, modes = torus(8, 5, 2)
    model = sscc.Model(vertices, faces.astype(dtype), modes)
    assert np.array_equal(model.faces, faces)


def test_subarrays_of_records(certs: sscc.Certificates) -> None:
    records = np.zeros(6, dtype=[("name", "S3"), ("weight", "f8")])
    records["weight"] = samples(1, 6, 0.4)[0]
    assert certs.check(records["weight"]) == certs.check(records["weight"].copy())


def test_broadcast_views_are_read_entry_by_entry(certs: sscc.Certificates) -> None:
    q = samples(1, 6, 0.4)[0]
    batch = certs.check_many(np.broadcast_to(q, (5, 6)))
    assert list(batch) == [certs.check(q)] * 5
    same = np.broadcast_to(0.2, (6,))
    assert certs.check(same) == certs.check(np.full(6, 0.2))


def test_arguments_are_copied() -> None:
    vertices, faces, modes = torus(8, 5, 2)
    model = sscc.Model(vertices, faces, modes)
    before = model.positions([1, 1])
    vertices[:], modes[:], faces[:] = 0, 0, 0
    assert np.array_equal(model.positions([1, 1]), before)
