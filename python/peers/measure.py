"""Times the testers of `testers.py` on the same meshes, and writes a record in CSV.

Usage: python measure.py --models DIR --out record.csv [--only TESTER] [--seconds N] [MESH ...]

Each tester answers each mesh in a process of its own, on one core (Linux), so that no library runs on several threads. A
time is the median of up to five readings, each the mean of calls that take 50 ms, in milliseconds of processor time of the
process, which other programs disturb less than the clock. `all_ms`, `first_ms` and `yes_no_ms` are from two NumPy arrays to the answer, with the tester's own mesh and
hierarchy made anew each time; `prepare_ms` is the part in which the mesh is made, as far as a call makes it alone. `again_ms`
(all pairs) and `again_yes_no_ms` are times from a mesh that is kept and was asked before. `memory_mb` is the largest memory of
all that, above that of the arrays and imports.
Embree and parry, which have no package for Python, are compiled first (`compiled.py`); without a compiler or a library of theirs
they are skipped, and the record says why, as it does for a package that is not installed.
A tester that takes longer than `--seconds` of processor time for all that is stopped, and the record says so.

`missing` and `extra` compare all pairs of triangles without a common vertex with the exact ones: those that `sscc` lists,
which its tests compare with rational arithmetic. Of testers that list faces, they count faces; of those that say yes or no
alone, `right` is all there is.
"""

from __future__ import annotations

import argparse
import csv
import json
import os
import resource
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import compiled
from testers import TESTERS, Tester

MESHES = {
    "bunny": "bunny_14964_closed.obj",
    "dragon": "dragon_77202_closed.ply",
    "double loop": "selfintersecting/doubleLoopWithCube.obj",
    "face": "ict_face/ict_face_neutral.obj",
    "cloth": "ccd_frames/cloth-funnel/227.ply",
}

COLUMNS = (
    "mesh triangles pairs tester version licence arithmetic prepare_ms all_ms first_ms yes_no_ms again_ms again_yes_no_ms lists missing extra right"
    " memory_mb date note"
).split()


# Some systems count processor time in ticks of 4 ms. Each reading is longer than ten.
READING = 0.05


def seconds_of(call: Callable[[], Any]) -> tuple[float, Any]:
    """The median of up to five readings, of two seconds in all, and the last answer. A reading is the mean of calls, as many as take
    [`READING`]."""
    times: list[float] = []
    total = 0.0
    while not times or (len(times) < 5 and total < 2.0):
        begin = time.process_time()
        taken, calls = 0.0, 0
        while taken < READING:
            answer = call()
            calls += 1
            taken = time.process_time() - begin
        times.append(taken / calls)
        total += taken
    return statistics.median(times), answer


def memory(field: str) -> float:
    """The memory of this process in MB: `VmRSS` now, `VmHWM` at most since it was reset."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(int(line.split()[1]) / 1024 for line in lines if line.startswith(field))


def distinct(found: Any, f: Any, faces: bool) -> set[Any]:
    """Pairs i < j of triangles without a common vertex, or faces."""
    found = np.asarray(found, np.int64)
    if faces:
        return set(found.tolist())
    found = found.reshape(-1, 2)
    share = (f[found[:, 0]][:, :, None] == f[found[:, 1]][:, None, :]).any(axis=(1, 2))
    return {(min(pair), max(pair)) for pair in found[~share].tolist()}


def answers(tester: Tester, x: Any, f: Any, exact: set[Any]) -> dict[str, Any]:
    """One row: times, the comparison with the exact answer, and memory."""
    Path("/proc/self/clear_refs").write_text("5")
    before = memory("VmRSS")
    row: dict[str, Any] = {}
    seconds, _ = seconds_of(lambda: tester.prepare(x, f))
    row["prepare_ms"] = 1e3 * seconds
    said: list[bool] = []
    for name, call in (("first_ms", tester.first), ("yes_no_ms", tester.yes_no), ("all_ms", tester.every)):
        if call is None:
            continue
        seconds, answer = seconds_of(lambda call=call: call(tester.prepare(x, f)))
        row[name] = 1e3 * seconds
        if name != "all_ms":
            said.append(bool(answer))
            continue
        row["memory_mb"] = memory("VmHWM") - before
        faces = tester.lists_faces
        row["lists"] = "faces" if faces else "pairs"
        right = {face for pair in exact for face in pair} if faces else exact
        found = distinct(answer, f, faces)
        row["missing"], row["extra"] = len(right - found), len(found - right)
        said.append(len(found) > 0)
    for name, call in (("again_ms", tester.every), ("again_yes_no_ms", tester.yes_no)):
        if call is not None and row[name.replace("again_ms", "all_ms").removeprefix("again_")] < 2000:
            prepared = tester.prepare(x, f)
            call(prepared)
            row[name] = 1e3 * seconds_of(lambda call=call: call(prepared))[0]
    row.setdefault("memory_mb", memory("VmHWM") - before)
    row.setdefault("lists", "yes or no")
    row["right"] = "yes" if all(answer == (len(exact) > 0) for answer in said) else "no"
    return row


def child(name: str, path: str) -> None:
    """Prints the row of one tester as JSON."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    data = np.load(path)
    tester = TESTERS[name]()
    row: dict[str, Any] = {"licence": tester.licence, "arithmetic": tester.arithmetic}
    row["version"] = tester.version()
    exact = {(a, b) for a, b in data["pairs"].tolist()}
    try:
        row |= answers(tester, data["x"], data["f"], exact)
    except ValueError as error:
        row["note"] = str(error)
    print("\n" + json.dumps(row))


def ask(name: str, path: str, seconds: int) -> dict[str, Any]:
    """The row of one tester, in a process of its own."""
    threads = {name: "1" for name in ("OMP_NUM_THREADS", "RAYON_NUM_THREADS", "TBB_NUM_THREADS", "IGL_NUM_THREADS")}
    done = subprocess.run(
        [sys.executable, __file__, "--child", name, path],
        capture_output=True,
        text=True,
        env=os.environ | threads,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 1)),
    )
    if done.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
        return {"note": f"stopped after {seconds} s"}
    if done.returncode != 0:
        last = (done.stderr.strip().splitlines() or [f"ended with {done.returncode}"])[-1]
        return {"note": last}
    row: dict[str, Any] = json.loads(done.stdout.strip().splitlines()[-1])
    return row


def main() -> None:
    """Writes the record."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--models", type=Path, default=os.environ.get("SSCC_MODELS"))
    parser.add_argument("--out", type=Path, default=Path("peers.csv"))
    parser.add_argument("--only", action="append", choices=list(TESTERS))
    parser.add_argument("--seconds", type=int, default=40)
    parser.add_argument("--child", nargs=2, help=argparse.SUPPRESS)
    parser.add_argument("mesh", nargs="*")
    arguments = parser.parse_args()
    if arguments.child:
        child(*arguments.child)
        return
    import sscc

    paths = {Path(mesh).stem: Path(mesh) for mesh in arguments.mesh}
    if arguments.models and not paths:
        paths = {name: Path(arguments.models) / mesh for name, mesh in MESHES.items()}
    if not paths:
        parser.error("name the folder of real models by --models or SSCC_MODELS, or meshes")
    names = arguments.only or list(TESTERS)
    skipped = {name: compiled.build(name) for name in names}
    with open(arguments.out, "w", newline="") as file, tempfile.TemporaryDirectory() as folder:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        for mesh, path in paths.items():
            model = sscc.modes.polynomial(path)  # a reader of meshes
            x, f = model.vertices, model.faces.astype(np.int64)
            pairs = sscc.self_intersections(x, f)
            data = f"{folder}/mesh.npz"
            np.savez(data, x=x, f=f, pairs=pairs)
            for name in names:
                row = {"note": skipped[name]} if skipped[name] else ask(name, data, arguments.seconds)
                row |= {"mesh": mesh, "triangles": len(f), "pairs": len(pairs), "tester": name}
                row["date"] = time.strftime("%Y-%m-%d")
                times = {key: f"{row[key]:.4g}" for key in row if key.endswith(("_ms", "_mb"))}
                writer.writerow(row | times)
                file.flush()
                print(mesh, name, times, row.get("note", ""), flush=True)


if __name__ == "__main__":
    main()
