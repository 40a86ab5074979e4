"""Writes the tables of the documents from the records in docs/records: `python docs/site/tables.py`; with `--check` it compares.

A table that follows a line `<!-- record: NAME.csv -->` is that record: a column for each of its columns, with the name in the
first row. `<!-- record: peers.csv, by tester -->` is a table of its own kind.
"""

from __future__ import annotations

import csv
import re
import sys
from pathlib import Path

DOCS = Path(__file__).parents[1]

MARK = re.compile(r"^(<!-- record: (\w+\.csv)(, by tester)? -->)\n\n(?:\|.*\n)*", re.MULTILINE)
NUMBER = re.compile(r"-?\d[\d.,]*(e-?\d+)?%?")


def shown(cell: str) -> str:
    """A cell of a table: whole parts of numbers from 1,000 on have separators."""
    found = re.fullmatch(r"(\d{4,})(\.\d+)?", cell)
    return f"{int(found[1]):,}{found[2] or ''}" if found else cell


def joined(head: list[str], rows: list[list[str]]) -> tuple[list[str], list[list[str]]]:
    """Two columns `X, before` and `X, after` as one."""
    before = [k for k in range(len(head) - 1) if head[k].endswith(", before") and head[k + 1].endswith(", after")]
    for k in reversed(before):
        head = [*head[:k], head[k] + " and after", *head[k + 2 :]]
        rows = [[*row[:k], f"{row[k]}, {row[k + 1]}", *row[k + 2 :]] for row in rows]
    return head, rows


def table(head: list[str], rows: list[list[str]]) -> str:
    """A Markdown table. Columns of numbers are aligned to the right."""
    head, rows = joined(head, rows)
    cells = [[shown(cell) for cell in row] for row in rows]
    numbers = [all(NUMBER.fullmatch(row[k]) or not row[k] for row in cells) for k in range(len(head))]
    lines = [head, ["---:" if number else "---" for number in numbers], *cells]
    escaped = [[cell.replace("|", "\\|") for cell in line] for line in lines]
    return "".join("|" + "|".join(f" {cell} " if cell else "  " for cell in line) + "|\n" for line in escaped)


def milliseconds(cell: str) -> str:
    """A time with three digits."""
    return shown(f"{float(f'{float(cell):.3g}'):g}") if cell else "-"


def by_tester(records: list[dict[str, str]]) -> str:
    """A row for each tester: milliseconds for all pairs and for yes or no on each mesh, and memory on the largest."""
    meshes = list(dict.fromkeys(record["mesh"] for record in records))
    largest = max(records, key=lambda record: int(record["triangles"]))["mesh"]
    first = {mesh: next(record for record in records if record["mesh"] == mesh) for mesh in meshes}
    head = ["tester", "version, licence", "arithmetic"]
    head += [f"{mesh}: {int(first[mesh]['triangles']):,} triangles, {first[mesh]['pairs']} pairs" for mesh in meshes]
    rows = []
    for tester in dict.fromkeys(record["tester"] for record in records):
        own = {record["mesh"]: record for record in records if record["tester"] == tester}
        known = next(record for record in own.values() if record["version"])
        row = [tester, f"{known['version'].split('.post')[0]}, {known['licence']}", known["arithmetic"]]
        rows.append(row + [answer(own[mesh]) for mesh in meshes] + [own[largest]["memory_mb"].split(".")[0] or "-"])
    return table([*head, f"memory, MB, {largest}"], rows)


def answer(record: dict[str, str]) -> str:
    """The times of one tester on one mesh, and what is wrong with its answer."""
    if record["note"]:
        return record["note"]
    text = " / ".join(milliseconds(record[key]) for key in ("all_ms", "yes_no_ms"))
    wrong = [f"{record[key]} {key}" for key in ("missing", "extra") if record[key] not in ("", "0")]
    return ", ".join([text, *wrong] + ([] if record["right"] == "yes" else ["wrong"]))


def replaced(text: str) -> str:
    """The text of a page with its tables as the records give them."""

    def write(found: re.Match[str]) -> str:
        with open(DOCS / "records" / found[2], newline="", encoding="utf-8") as file:
            head, *rows = csv.reader(file)
        made = by_tester([dict(zip(head, row, strict=True)) for row in rows]) if found[3] else table(head, rows)
        return f"{found[1]}\n\n{made}"

    return MARK.sub(write, text)


def main() -> None:
    """Writes or compares the tables of all pages."""
    used = set()
    for page in sorted(DOCS.glob("*.md")):
        text = page.read_text(encoding="utf-8")
        used |= {found[2] for found in MARK.finditer(text)}
        new = replaced(text)
        if new == text:
            continue
        if sys.argv[1:] == ["--check"]:
            raise SystemExit(f"error: docs/{page.name}: a table is not what its record gives: python docs/site/tables.py")
        page.write_text(new, encoding="utf-8")
    unused = {path.name for path in (DOCS / "records").glob("*.csv")} - used
    if unused:
        raise SystemExit(f"error: docs/records/{sorted(unused)[0]}: no page has a table of this record")


if __name__ == "__main__":
    main()
