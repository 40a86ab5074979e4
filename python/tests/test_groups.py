"""Groups of triangles: pairs of groups that do not count."""

from __future__ import annotations

import pickle
import re
from typing import Any

import numpy as np
import pytest

import sscc
from shapes import samples, torus


@pytest.fixture(scope="module")
def whole() -> sscc.Model:
    return sscc.Model(*torus(24, 12, 6))


def test_pairs_of_groups_do_not_count(whole: sscc.Model) -> None:
    groups = np.arange(len(whole.faces)) * 3 // len(whole.faces)
    plain = whole.certify(epsilon=0.5)
    left_out = 0
    for ignored in ([(0, 1)], [(2, 2), (1, 0)], np.array([[0, 0], [1, 1], [2, 2]], dtype=np.uint8)):
        certs = whole.certify(groups=groups, ignore_groups=ignored, epsilon=0.5)
        detector = sscc.Detector(whole.faces, groups=groups, ignore_groups=ignored)
        assert certs.digest != plain.digest
        table = np.ones((3, 3), dtype=bool)
        for a, b in np.asarray(ignored):
            table[a, b] = table[b, a] = False
        for q in samples(60, 6, 0.6):
            pairs = plain.check(q).pairs
            counted = pairs[table[groups[pairs[:, 0]], groups[pairs[:, 1]]]]
            assert np.array_equal(certs.check(q).pairs, counted)
            assert np.array_equal(detector.check(whole.positions(q)).pairs, counted)
            left_out += len(pairs) - len(counted)
    assert left_out > 50


def test_without_ignored_pairs_groups_change_nothing(whole: sscc.Model) -> None:
    groups = [0] * len(whole.faces)
    ignored: Any
    for ignored in (None, [], np.zeros((0, 2), dtype=int)):
        assert whole.certify(groups=groups, ignore_groups=ignored).digest == whole.certify().digest
        detector = sscc.Detector(whole.faces, groups=groups, ignore_groups=ignored)
        assert detector.groups is None and detector.ignored_groups.shape == (0, 2)


@pytest.mark.parametrize("ignored", [[(2, 0)], [(1, 1), (0, 0), (0, 1), (2, 0), (1, 2), (1, 0)]])
def test_detectors_keep_their_groups(whole: sscc.Model, ignored: list[tuple[int, int]]) -> None:
    groups = np.arange(len(whole.faces)) % 3
    detector = sscc.Detector(whole.faces, groups=groups, ignore_groups=ignored)
    expected = sorted({(min(pair), max(pair)) for pair in ignored})
    x = whole.positions(samples(60, 6, 0.6)[16])
    for kept in (detector, pickle.loads(pickle.dumps(detector))):
        assert kept.groups is not None and np.array_equal(kept.groups, groups)
        assert [tuple(pair) for pair in kept.ignored_groups.tolist()] == expected
        assert kept.check(x) == detector.check(x)
    classes = sscc.Detector(whole.faces, weld=np.arange(len(whole.vertices)), groups=groups, ignore_groups=ignored)
    assert classes.check(x) == detector.check(x) != sscc.Detector(whole.faces).check(x)


def test_all_pairs_of_two_meshes_count(whole: sscc.Model) -> None:
    detector = sscc.Detector(whole.faces, groups=np.zeros(len(whole.faces), int), ignore_groups=[(0, 0)])
    plain = sscc.Detector(whole.faces)
    x, y = whole.vertices, whole.vertices + [0.5, 0, 0]
    assert detector.against(x, detector, y) == plain.against(x, plain, y) != detector.check(x)


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"ignore_groups": [(0, 1)]}, ValueError, "ignore_groups needs groups"),
        ({"groups": [0, 1]}, ValueError, "groups has shape [2]: one number for each of 576 triangles"),
        ({"groups": np.zeros((576, 1), dtype=int)}, ValueError, "groups has shape [576, 1]"),
        ({"groups": np.zeros(576)}, TypeError, "groups is an array of float64: integers were expected"),
        ({"groups": np.full(576, -1)}, ValueError, "groups: -1 is no group"),
        ({"groups": np.full(576, 1 << 40)}, ValueError, "groups: 1099511627776 is no group"),
        ({"groups": np.full(576, 65536)}, ValueError, "groups: triangle 0 (counted from 0) is in group 65536"),
        (
            {"groups": np.zeros(576, dtype=int), "ignore_groups": [(0, 1)]},
            ValueError,
            "groups: group 1 does not exist: those of the triangles are 0 to 0",
        ),
        (
            {"groups": np.zeros(576, dtype=int), "ignore_groups": [0, 1]},
            ValueError,
            "ignore_groups has shape [2]: pairs of groups (n, 2) were expected",
        ),
    ],
)
def test_invalid_groups_are_refused(
    whole: sscc.Model, options: dict[str, Any], error: type[Exception], message: str
) -> None:
    with pytest.raises(error, match="^" + re.escape(message)):
        whole.certify(**options)
    with pytest.raises(error, match="^" + re.escape(message)):
        sscc.Detector(whole.faces, **options)
