"""How far the reduced coordinates of a model in SOFA can go until its surface intersects itself.

The plugin ModelOrderReduction writes the modes to a text file, here those of a mouth. In a scene, the rest positions are
``node.getMechanicalState().rest_position.array()``, and the faces those of its topology: triangles, or tetrahedra.

    python sofa_modes.py
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
import sscc
from mouth import mouth


def write_modes(path: Path, modes: np.ndarray) -> None:
    """Writes modes (3V, r) as the plugin does."""
    np.savetxt(path, modes, fmt="%10.5f", header=f"{modes.shape[0]} {modes.shape[1]}", comments="")


def main() -> list[sscc.Sweep]:
    rest, faces, modes = mouth()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "modes.txt"
        write_modes(path, modes.reshape(3 * len(rest), -1))
        body = sscc.from_sofa(rest, faces, path, rank=3)
    sweeps = body.certify().sweep((-2, 2))
    for sweep in sweeps:
        first = "free" if sweep.first_hit is None else f"touches itself at {sweep.first_hit:.4f}"
        print(f"coordinate {sweep.mode} from {sweep.start} to {sweep.end}: {first}")
    return sweeps


if __name__ == "__main__":
    main()
