"""Which samples of a statistical shape model intersect themselves, and how far towards each the shape is free.

    python pca_shapes.py
"""

from __future__ import annotations

import numpy as np
import sscc
from mouth import mouth

SUBJECTS, COMPONENTS, SAMPLES = 60, 4, 500


def population(random: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Scans of people with corresponding vertices, (n, V, 3), and their faces."""
    vertices, faces, modes = mouth()
    habits = random.normal(size=(SUBJECTS, modes.shape[2])) * [0.5, 0.35, 0.5, 0.5]
    return vertices + np.einsum("nk,vck->nvc", habits, modes), faces


def main() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    random = np.random.default_rng(1)
    scans, faces = population(random)

    # The statistical model: the mean, and principal components in units of their standard deviation.
    mean = scans.mean(axis=0)
    _, sizes, axes = np.linalg.svd((scans - mean).reshape(SUBJECTS, -1), full_matrices=False)
    deviations = sizes[:COMPONENTS] / np.sqrt(SUBJECTS - 1)
    components = (axes[:COMPONENTS] * deviations[:, None]).T.reshape(*mean.shape, COMPONENTS)

    model = sscc.Model(mean, faces, components)
    certificates = model.certify()
    Q = random.normal(size=(SAMPLES, COMPONENTS))
    colliding = certificates.check_many(Q).colliding
    print(f"{colliding.sum()} of {SAMPLES} samples intersect themselves")

    # The scale up to which the line from the mean to each sample is proven free; from 1 on it contains the sample.
    steps = np.array([certificates.safe_scale(q) for q in Q])
    print(f"safe scales: minimum {steps.min():.2f}, median {np.median(steps):.2f}")
    repaired = Q * np.minimum(steps, 1)[:, None] * (1 - 1e-9)
    print(f"at the safe scale, {certificates.check_many(repaired).count.sum()} pairs of triangles collide")
    return colliding, steps, certificates.check_many(repaired).colliding


if __name__ == "__main__":
    main()
