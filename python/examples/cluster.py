"""A library of models, one large model and many configurations on a cluster; here two processes of this machine.

    python cluster.py
"""

from __future__ import annotations

import numpy as np
import sscc
import sscc.batch
from distributed import Client, LocalCluster
from mouth import mouth


def main(client: Client) -> tuple[sscc.batch.Library, sscc.Certificates, sscc.Batch]:
    vertices, faces, modes = mouth()
    models = {f"width {width}": sscc.Model(vertices * [width, 1, 1], faces, modes) for width in (0.8, 1.0, 1.2)}
    library = sscc.batch.certify(models, client)
    for name, certificates in library.certificates.items():
        print(f"{name}: free for |z| < {certificates.root_radius:.3f}")

    large = sscc.batch.certify_in_shards(models["width 1.0"], client)
    print(f"same root radius by shards: {large.root_radius == library.certificates['width 1.0'].root_radius}")

    Q = np.random.default_rng(3).normal(scale=0.5, size=(20_000, 4))
    answers = sscc.batch.check(large, Q, client)
    print(f"{answers.colliding.sum()} of {len(answers)} configurations collide")
    return library, large, answers


if __name__ == "__main__":
    with LocalCluster(n_workers=2, threads_per_worker=1) as cluster, Client(cluster) as client:
        main(client)
