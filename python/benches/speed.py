"""What Python costs: single checks and batches beside the same in Rust, in one process, on the same q.

Usage: python benches/speed.py MODEL.model.safetensors [CERTIFICATES.sscc.safetensors]

Without a file: a torus of 16,000 triangles with 12 modes, made here. Build the package in release mode first
(``maturin develop --release``).
"""

from __future__ import annotations

import statistics
import sys
import time
from pathlib import Path

import numpy as np

import sscc
from sscc._sscc import _core_seconds

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from shapes import F64, torus  # noqa: E402

#: Rounds of each measurement. Of single checks the median is told, of batches the least, as other work only adds to it.
ROUNDS = 15


def single(certs: sscc.Certificates, qs: F64, label: str) -> None:
    """The median of one check, in Python and in Rust. Reading the clock costs both the same, and is taken off."""
    clock, python, rust = [], [], []
    rows = list(qs)
    for _ in range(ROUNDS):
        for q in rows:
            begin = time.perf_counter_ns()
            end = time.perf_counter_ns()
            clock.append(end - begin)
            begin = time.perf_counter_ns()
            certs.check(q)
            end = time.perf_counter_ns()
            python.append(end - begin)
        rust += [1e9 * seconds for seconds in _core_seconds(certs, qs, 1)[1]]
    ours = statistics.median(python) - statistics.median(clock)
    theirs = statistics.median(rust)
    more = (ours - theirs) / 1e3
    print(f"check, {label:27} Python {ours / 1e3:9.2f} us   Rust {theirs / 1e3:9.2f} us   {more:+.2f} us")


def batch(certs: sscc.Certificates, qs: F64, label: str) -> None:
    """A whole batch on all cores, in Python and in Rust by turns."""
    python, rust = [], []
    for _ in range(ROUNDS):
        begin = time.perf_counter()
        certs.check_many(qs, progress=False)
        python.append(time.perf_counter() - begin)
        rust.append(_core_seconds(certs, qs, None, False)[0])
    ours, theirs = min(python), min(rust)
    count = f"{len(qs):,} q"
    print(f"check_many, {label:17} {count:>9} Python {ours:7.3f} s   Rust {theirs:7.3f} s   {ours / theirs - 1:+.1%}")


def main() -> None:
    """Measures certified, free and colliding configurations."""
    if len(sys.argv) > 1:
        model = sscc.Model.load(sys.argv[1])
    else:
        model = sscc.Model(*torus(160, 50, 12))
    certs = sscc.Certificates.load(sys.argv[2], model) if len(sys.argv) > 2 else model.certify()
    print(model, certs)
    qs = np.random.default_rng(3).normal(size=(100_000, model.rank))
    qs /= np.array([certs.norm(q) for q in qs])[:, None]
    inside, across = qs * certs.root_radius * 0.9, qs * certs.root_radius * np.linspace(0.5, 4, len(qs))[:, None]
    single(certs, inside[:2000], "by the root alone")
    single(certs, across[::500], "0.5 to 4 root radii")
    batch(certs, inside, "by the root alone")
    batch(certs, np.tile(inside, (10, 1)), "by the root alone")
    batch(certs, across[::200], "0.5 to 4 radii")


if __name__ == "__main__":
    main()
