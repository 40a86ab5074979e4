"""Answers equal libigl's exact self-intersections at random configurations of each of three real models."""

from __future__ import annotations

from pathlib import Path

import pytest

import exact

@pytest.mark.usefixtures("libigl")
@pytest.mark.parametrize("name", exact.MODELS)
def test_answers_equal_libigls(name: str, models: Path) -> None:
    colliding, pairs, wrong = exact.differences(name, models)
    print(f"{name}: {exact.COMPARED} configurations, {colliding} colliding, {pairs} pairs, {len(wrong)} differ")
    assert wrong == []
    assert exact.COMPARED / 5 < colliding <= exact.COMPARED and pairs > colliding
