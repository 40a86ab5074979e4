"""Frames of a deforming mesh, without modes: which intersect themselves, where contacts begin, and where they touch a
second mesh.

    python deforming.py
"""

from __future__ import annotations

import numpy as np
import sscc
from mouth import mouth

FRAMES = 120


def performance() -> tuple[np.ndarray, np.ndarray]:
    """Frames of a mouth that closes and bites, (T, V, 3), and its faces. A file of frames would do as well."""
    vertices, faces, modes = mouth()
    time = np.linspace(0, 2 * np.pi, FRAMES)
    weights = np.stack([1 - np.cos(time), np.sin(time), np.cos(2 * time), np.sin(3 * time)], axis=1) * 0.5
    return vertices + np.einsum("vck,tk->tvc", modes, weights), faces


def spoon(time: float) -> tuple[np.ndarray, np.ndarray]:
    """A flat square in the opening of the mouth, which moves down."""
    corners = np.array([[-0.2, 0, -1], [0.2, 0, -1], [0.2, 0, 1], [-0.2, 0, 1]])
    return corners + [0, 0.3 - 0.6 * time, 0], np.array([[0, 1, 2], [0, 2, 3]])


def main() -> tuple[sscc.DetectorBatch, list[int], np.ndarray]:
    frames, faces = performance()
    print(f"frame 0 alone: {len(sscc.self_intersections(frames[0], faces))} pairs of triangles")

    detector = sscc.Detector(faces, frames[0])
    batch = detector.check_many(frames)
    print(f"{batch.colliding.sum()} of {FRAMES} frames intersect themselves, frame {batch.count.argmax()} most")

    # Frames between which a free mesh begins to collide: each vertex moves on a straight line.
    free = np.flatnonzero(~batch.colliding[:-1])
    begins = [int(t) for t in free if detector.continuous(frames[t], frames[t + 1]).colliding]
    print(f"contacts begin after frames {begins}")

    second = sscc.Detector(spoon(0)[1])
    met = np.array([detector.against(frames[t], second, spoon(t / FRAMES)[0]).colliding for t in range(FRAMES)])
    print(f"the spoon touches the mouth in {met.sum()} frames")
    return batch, begins, met


if __name__ == "__main__":
    main()
