"""The cost of Python: single checks and batches in Python and in Rust, in one process, on the same q.

Usage: python benches/speed.py MODEL.model.safetensors [CERTIFICATES.sscc.safetensors]

Without a file: a generated torus of 16,000 triangles with 12 modes. Build the package in release mode first
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

#: Repetitions of each measurement. Single checks report the median, batches the minimum, as other work only adds time.
REPETITIONS = 15


def single(certs: sscc.Certificates, qs: F64, label: str) -> None:
    """Prints the median of one check in Python and in Rust. The time to read the clock is subtracted in Python."""
    clock, python, rust = [], [], []
    rows = list(qs)
    for _ in range(REPETITIONS):
        for q in rows:
            begin = time.perf_counter_ns()
            end = time.perf_counter_ns()
            clock.append(end - begin)
            begin = time.perf_counter_ns()
            certs.check(q)
            end = time.perf_counter_ns()
            python.append(end - begin)
        rust += [1e9 * seconds for seconds in _core_seconds(certs, qs, 1)[1]]
    in_python = statistics.median(python) - statistics.median(clock)
    in_rust = statistics.median(rust)
    more = (in_python - in_rust) / 1e3
    print(f"check, {label:27} Python {in_python / 1e3:9.2f} us   Rust {in_rust / 1e3:9.2f} us   {more:+.2f} us")


def batch(certs: sscc.Certificates, qs: F64, label: str) -> None:
    """Prints the minimum of a batch on all cores, in Python and in Rust, interleaved."""
    python, rust = [], []
    for _ in range(REPETITIONS):
        begin = time.perf_counter()
        certs.check_many(qs, progress=False)
        python.append(time.perf_counter() - begin)
        rust.append(_core_seconds(certs, qs, None, False)[0])
    in_python, in_rust = min(python), min(rust)
    count = f"{len(qs):,} q"
    more = f"{in_python / in_rust - 1:+.1%}"
    print(f"check_many, {label:17} {count:>9} Python {in_python:7.3f} s   Rust {in_rust:7.3f} s   {more}")


def main() -> None:
    """Measures configurations inside the root's radius, and free and colliding ones beyond it."""
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
