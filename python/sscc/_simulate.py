"""Simulations of scenes."""

from __future__ import annotations

import json
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

from sscc._sscc import _simulate
from sscc._text import counted, quoted


class Simulation(NamedTuple):
    """The results of a simulation."""

    summary: dict[str, Any]
    """The keys of ``sscc simulate --json``."""
    folder: Path
    """The folder of the results."""
    files: list[Path]
    """The written files: motions (``.npz``), an animation (``.glb``), a report (``.html``), sound."""

    def __repr__(self) -> str:
        steps, colliding = counted(self.summary["steps"], "step"), self.summary["colliding_steps"]
        scene, files = quoted(self.summary["scene"]), counted(len(self.files), "file")
        return f"<sscc.Simulation: {scene}, {steps}, {colliding:,} colliding, {files} in {quoted(self.folder)}>"


def simulate(
    scene: str | PathLike[str],
    out: str | PathLike[str] | None = None,
    *,
    steps: int | None = None,
    restart: bool = False,
    models: str | PathLike[str] | None = None,
    cache: str | PathLike[str] | None = None,
    threads: int | None = None,
) -> Simulation:
    """Simulates the bodies of a scene, as ``sscc simulate`` does.

    scene: a ``.toml`` file, or the name of a scene that comes with the package, such as "spring".
    out: the folder to write to. None means the scene's name. A stopped run in this folder is resumed.
    steps: number of steps from the beginning. None means the scene's number.
    restart: if True, simulates from the beginning, even if the folder has a stopped run.
    models: the folder of bunny_14964_closed.obj and dragon_77202_closed.ply. None means the folder in the environment
        variable SSCC_MODELS; if that is not set, embedded shapes replace the models.
    cache: the folder that keeps models and certificates between runs.
    threads: the number of threads. None means all cores.

    A bar shows the progress of the steps on a terminal or in a notebook. Ctrl-C stops the simulation after the current
    step and writes the steps until then; the same call resumes it. Several threads may simulate at the same time, each
    in a folder of its own. Raises FileNotFoundError, OSError, ValueError.
    """
    summary, folder, files = _simulate(scene, out, steps, restart, models, cache, threads)
    return Simulation(json.loads(summary), Path(folder), [Path(file) for file in files])
