"""Simulations of scenes."""

from __future__ import annotations

import json
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

from sscc._sscc import _simulate


class Simulation(NamedTuple):
    """The results of a simulation."""

    summary: dict[str, Any]
    """The keys of ``sscc simulate --json``."""
    folder: Path
    """Where its results are."""
    files: list[Path]
    """What was written: motions (``.npz``), an animation (``.glb``), a report (``.html``), sound."""


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
    """Lets the bodies of a scene move, as ``sscc simulate`` does.

    scene: a ``.toml`` file, or the name of a scene that comes with the package, such as "spring".
    out: the folder to write to; None: the scene's name. A run that was stopped goes on from there.
    steps: how many from the beginning; None: those of the scene. ``restart`` begins again.
    models, cache: the folder of real models; where models and certificates are kept from run to run.

    A bar shows the progress of the steps, on a terminal or in a notebook. Ctrl-C stops after the step at hand; what was
    simulated until then is written, and the same call continues from there. Several threads may simulate at the same
    time, each in a folder of its own. Raises FileNotFoundError, OSError, ValueError.
    """
    summary, folder, files = _simulate(scene, out, steps, restart, models, cache, threads)
    return Simulation(json.loads(summary), Path(folder), [Path(file) for file in files])
