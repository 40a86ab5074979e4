"""Objects release their memory."""

from __future__ import annotations

import gc
import pickle
from pathlib import Path

import pytest

import sscc
from shapes import samples, torus

STATM = Path("/proc/self/statm")


def resident() -> int:
    """Returns the resident memory of this process, in bytes."""
    gc.collect()
    return int(STATM.read_text().split()[1]) * 4096


@pytest.mark.skipif(not STATM.exists(), reason="only Linux has /proc/self/statm")
def test_memory_does_not_grow_over_hundreds_of_cycles() -> None:
    vertices, faces, modes = torus(5, 4, 2)
    qs = samples(4, 2, 0.4)

    def cycle() -> None:
        model = sscc.Model(vertices, faces, modes)
        certs = model.certify(scheme="paper", epsilon=0.5, threads=1)
        kinetic = certs.kinetic()
        for q in qs[:2]:
            kinetic.check(q).pairs.sum()
            certs.check(q).pairs.sum()
        certs.continuous(qs[0], qs[1]).times.sum()
        certs.safe_scale(qs[0])
        batch = certs.check_many(qs, threads=2)
        assert pickle.loads(pickle.dumps(batch)) == batch
        with pytest.raises(ValueError):
            certs.check([0.0])
        assert len(certs.hierarchy.order) == 40

    for _ in range(50):
        cycle()
    before = resident()
    for _ in range(400):
        cycle()
    grown = resident() - before
    # A leak of 11 kB in each cycle would fail.
    assert grown < 4 << 20, f"{grown / 2**20:.1f} MB more after 400 cycles"
