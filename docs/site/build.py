"""Builds the site and checks it: `python docs/site/build.py --command sscc --out DIR [--rustdoc DIR]`.

`cargo xtask site` calls it with the packages of requirements.txt. Nothing in docs/ is written.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import check
import sheet

HERE = Path(__file__).parent
ROOT = HERE.parents[1]


def run(*command: str | Path, wanted: int = 0, folder: Path = ROOT) -> None:
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    if done.returncode != wanted:
        raise SystemExit(f"error: {Path(command[0]).name} ended with {done.returncode}:\n{done.stdout}{done.stderr}")


def report(command: Path, site: Path) -> None:
    """Writes the report that how-it-works.md embeds, by the command on that page."""
    text = (ROOT / "docs/how-it-works.md").read_text(encoding="utf-8")
    (line,) = (line for line in text.splitlines() if line.startswith("sscc check sheet.obj "))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        sheet.write(folder)
        run(command, *line.split()[1:], wanted=1, folder=folder)  # 1: it collides
        (site / "reports").mkdir()
        shutil.copy(folder / "sheet.html", site / "reports")


def main() -> None:
    """Builds and checks."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--command", type=Path, required=True, help="the command sscc")
    parser.add_argument("--out", type=Path, required=True, help="the folder of the site; it is replaced")
    parser.add_argument("--rustdoc", type=Path, help="the documentation of the crates, as `cargo doc` writes it")
    arguments = parser.parse_args()
    site = arguments.out.resolve()
    for script in ("figures.py", "tables.py"):
        run(sys.executable, HERE / script, "--check")
    if arguments.rustdoc:
        os.environ["SSCC_RUSTDOC"] = "1"
    run(sys.executable, "-m", "mkdocs", "--quiet", "build", "--strict", "--site-dir", site)
    report(arguments.command.resolve(), site)
    if arguments.rustdoc:
        shutil.copytree(arguments.rustdoc, site / "rustdoc")
    check.main(site)


if __name__ == "__main__":
    main()
