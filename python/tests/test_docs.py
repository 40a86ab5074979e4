"""The examples of docs/python.md run."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from conftest import PROJECT
from scenes import character


def blocks(page: str) -> list[str]:
    text = (PROJECT / page).read_text()
    return re.findall(r"^```python\n(.*?)^```", text, flags=re.MULTILINE | re.DOTALL)


@pytest.mark.usefixtures("mujoco", "usd")
def test_the_examples_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    character(tmp_path)
    found = blocks("docs/python.md")
    assert len(found) > 5
    names: dict[str, Any] = {}
    for block in found:
        exec(compile(block, "docs/python.md", "exec"), names)
