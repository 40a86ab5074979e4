"""The frames of a performance in which a face with blendshapes touches itself, and the times at which contacts begin.

    python performance.py [FACE.glb [MESH]]
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np
import sscc
from mouth import mouth_glb

FRAMES = 240


def performance(rank: int) -> np.ndarray:
    """Weights for each frame (FRAMES, rank): every target moves between 0 and 1 at its own frequency."""
    time = np.linspace(0, 1, FRAMES)[:, None]
    frequency = 2 * np.pi * (1 + 0.37 * np.arange(rank))
    return 0.5 - 0.5 * np.cos(frequency * time)


def main(file: str | None = None, mesh: str | None = None) -> tuple[np.ndarray, dict[int, float]]:
    with tempfile.TemporaryDirectory() as folder:
        model = sscc.Model.load(file or mouth_glb(Path(folder)), mesh_name=mesh)
    print(f"{model}, targets: {', '.join(model.mode_names)}")

    # Ignores pairs that collide at rest, such as closed lips.
    certificates = model.certify(ignore_rest=True)
    weights = performance(model.rank)
    colliding = certificates.check_many(weights).colliding
    print(f"{colliding.sum()} of {FRAMES} frames collide")

    # A continuous query finds every contact between two frames, and its time.
    begins = {}
    for frame in range(FRAMES - 1):
        if not colliding[frame]:
            impacts = certificates.continuous(weights[frame], weights[frame + 1])
            if len(impacts.times):
                begins[frame] = frame + impacts.times.min()
    for time in begins.values():
        print(f"  contact begins at frame {time:.3f}")
    return colliding, begins


if __name__ == "__main__":
    main(*sys.argv[1:])
