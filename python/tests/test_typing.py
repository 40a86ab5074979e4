"""The stubs are strict and complete, and agree with the module."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]

#: stubtest does not find this configuration by itself.
CONFIG = ("--mypy-config-file", "pyproject.toml")


def run(*arguments: str) -> None:
    done = subprocess.run([sys.executable, "-P", "-m", *arguments], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_package_and_tests_are_typed_strictly() -> None:
    run("mypy", "--strict")


def test_stubs_agree_with_the_module() -> None:
    # Private functions, such as functions for unpickling, need no stub.
    run("mypy.stubtest", "sscc", "--ignore-disjoint-bases", "--ignore-missing-stub", *CONFIG)
