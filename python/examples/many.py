"""100,000 configurations at once, on all cores.

    python many.py
"""

from __future__ import annotations

import time

import numpy as np
import sscc
from mouth import mouth

COUNT = 100_000


def main(count: int = COUNT) -> sscc.Batch:
    certificates = sscc.Model(*mouth()).certify()
    Q = np.random.default_rng(2).normal(scale=0.5, size=(count, 4))
    start = time.perf_counter()
    answers = certificates.check_many(Q)
    seconds = time.perf_counter() - start
    print(f"{count} answers in {seconds:.2f} s: {answers.colliding.sum()} collide,")
    print(f"{answers.root_certified.sum()} are proven free by one comparison")
    # The pairs of all answers are in one array: those of row i are answers.pairs[offsets[i]:offsets[i + 1]].
    worst = int(answers.count.argmax())
    first, end = answers.offsets[worst : worst + 2]
    print(f"row {worst} has the most pairs: {end - first}; the first is {answers.pairs[first].tolist()}")
    return answers


if __name__ == "__main__":
    main()
