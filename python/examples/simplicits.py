"""Poses of a body of Simplicits in which its surface intersects itself.

Kaolin learns the weights of the handles. Here they are smooth functions, so that the example needs NumPy alone. With Kaolin:

    weights = skinning_module.compute_skinning_weights(vertices).detach()
    transforms = scene.get_object_transforms(0)[:, :3]

    python simplicits.py
"""

from __future__ import annotations

import numpy as np
import sscc
from mouth import mouth

LEARNED, POSES = 4, 200


def main() -> np.ndarray:
    random = np.random.default_rng(1)
    vertices, faces, _ = mouth()
    angle = np.arctan2(vertices[:, 1], vertices[:, 0])
    learned = np.cos(angle[:, None] - 2 * np.pi * np.arange(LEARNED) / LEARNED)
    weights = np.concatenate([learned, np.ones((len(vertices), 1))], axis=1)  # the last handle moves all vertices

    body = sscc.from_simplicits(vertices, faces, weights)
    transforms = 0.15 * random.normal(size=(POSES, LEARNED + 1, 3, 4))  # relative ones: 0 at rest
    colliding = body.certify().check_many(transforms.reshape(POSES, -1)).colliding
    print(f"{colliding.sum()} of {POSES} poses collide")
    return colliding


if __name__ == "__main__":
    main()
