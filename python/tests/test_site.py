"""The checks of the site find each kind of problem, and its tables are those of the records."""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

import pytest

from conftest import PROJECT


@pytest.fixture(autouse=True)
def scripts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(PROJECT / "docs/site"))


def script(name: str) -> Any:
    return importlib.import_module(name)


@pytest.mark.parametrize(
    ("body", "problem"),
    [
        ("", None),
        ('<a href="b.html#here">b</a> <a href="#top">up</a> <a href="https://example.org">x</a>', None),
        ('<a href="c.html">c</a>', "index.html: c.html: there is no such file"),
        ('<a href="b.html#there">b</a>', "index.html: b.html#there: there is no such anchor"),
        ('<img src="none.png">', "index.html: none.png: there is no such file"),
        ('<img src="https://example.org/a.png">', "index.html: loads https://example.org/a.png"),
        ('<script src="//example.org/a.js"></script>', "index.html: loads //example.org/a.js"),
        ('<a href="javascript:x()">x</a>', "index.html: loads javascript:x()"),
        ('<p id="top"></p>', "index.html: two elements have the id top"),
        (100_000 * "x", "index.html: 100,048 bytes with style and script; at most 100,000"),
    ],
)
def test_problems_of_a_site_are_found(tmp_path: Path, body: str, problem: str | None) -> None:
    (tmp_path / "index.html").write_text(f'<h1 id="top"></h1><script src="a.js"></script>{body}')
    (tmp_path / "b.html").write_text('<p id="here"></p>')
    (tmp_path / "a.js").write_text("x;")
    assert script("check").problems(tmp_path) == ([problem] if problem else [])


@pytest.mark.parametrize("text", ["x='https://example.org'", "a{background:url(a.png)}", "@import 'a.css';"])
def test_styles_and_scripts_load_nothing(tmp_path: Path, text: str) -> None:
    (tmp_path / "index.html").write_text("")
    (tmp_path / "a.css").write_text(text)
    assert len(script("check").problems(tmp_path)) == 1


def test_tables_are_made_from_records() -> None:
    made = script("tables").table(["a", "b|c", "x, before", "x, after"], [["1234.5", "n", "1", "2"], ["", "m", "3", "4"]])
    assert made == (
        "| a | b\\|c | x, before and after |\n| ---: | --- | --- |\n| 1,234.5 | n | 1, 2 |\n|  | m | 3, 4 |\n"
    )
    marked = 0
    for page in ("results", "benchmarks"):
        text = (PROJECT / f"docs/{page}.md").read_text(encoding="utf-8")
        assert script("tables").replaced(text) == text
        marked += text.count("<!-- record: ")
    assert marked >= 12
