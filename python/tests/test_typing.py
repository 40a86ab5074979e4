"""The stubs are strict, complete and true."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]


def run(*arguments: str) -> None:
    done = subprocess.run([sys.executable, "-P", "-m", *arguments], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_package_and_tests_are_typed_strictly() -> None:
    run("mypy", "--strict")


def test_stubs_say_what_is_there() -> None:
    # Of private things nothing is promised, such as of functions that unpickle.
    run("mypy.stubtest", "sscc", "--ignore-disjoint-bases", "--ignore-missing-stub")
