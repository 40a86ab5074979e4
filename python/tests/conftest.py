"""Fixtures: models, the command, real data, and the log of skipped tests."""

from __future__ import annotations

import importlib.util
import os
from pathlib import Path

import pytest

import sscc
from shapes import torus

PROJECT = Path(__file__).parents[2]


def skip(test: str, reason: str) -> None:
    """Skips a test, and adds it to the list of skipped tests of ``cargo xtask test``."""
    log = os.environ.get("SSCC_SKIP_LOG")
    if log:
        with open(log, "a") as file:
            file.write(f"SKIPPED: python: {test}: {reason}\n")
    pytest.skip(reason)


@pytest.fixture
def libigl(request: pytest.FixtureRequest) -> None:
    """Skips the test if the package libigl is not installed."""
    needs(request, "igl")


@pytest.fixture
def ipctk(request: pytest.FixtureRequest) -> None:
    """Skips the test if the package ipctk is not installed."""
    needs(request, "ipctk")


@pytest.fixture
def mujoco(request: pytest.FixtureRequest) -> None:
    """Skips the test if the package mujoco is not installed."""
    needs(request, "mujoco")


@pytest.fixture
def usd(request: pytest.FixtureRequest) -> None:
    """Skips the test if the package usd-core is not installed."""
    needs(request, "pxr")


def needs(request: pytest.FixtureRequest, module: str) -> None:
    """Skips a test if a module is not installed."""
    if importlib.util.find_spec(module) is None:
        skip(request.node.name, f"the package {module} is not installed for this interpreter")


@pytest.fixture
def models(request: pytest.FixtureRequest) -> Path:
    """Returns the folder of real models, which is not part of the project."""
    folder = Path(os.environ.get("SSCC_MODELS") or PROJECT.parent / "shared" / "models")
    if not folder.is_dir():
        skip(request.node.name, "no real models found; set SSCC_MODELS to their folder")
    return folder


@pytest.fixture
def command(request: pytest.FixtureRequest) -> Path:
    """Returns the ``sscc`` command that ``cargo xtask python`` has built."""
    path = os.environ.get("SSCC_COMMAND")
    if not path:
        skip(request.node.name, "SSCC_COMMAND does not name the sscc command")
    assert path is not None
    return Path(path)


@pytest.fixture(scope="session")
def model() -> sscc.Model:
    """Returns a torus of 576 triangles with 6 smooth modes, shared by all tests."""
    return sscc.Model(*torus(24, 12, 6))


@pytest.fixture(scope="session")
def certs(model: sscc.Model) -> sscc.Certificates:
    """Returns certificates of that torus."""
    return model.certify()
