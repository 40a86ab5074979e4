"""Checks the built site: every link and anchor, that pages load nothing from elsewhere, and the size of the first page."""

from __future__ import annotations

import re
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

#: Bytes of the first page with its style and script, without pictures and the index of the search.
LIMIT = 100_000

#: Folders of the site that other programs wrote: links to them are checked, not those in them.
FOREIGN = ("rustdoc", "reports")

#: Attributes by which a page loads something.
LOADED = {("link", "href"), ("script", "src"), ("img", "src"), ("iframe", "src"), ("source", "src"), ("object", "data")}


class Page(HTMLParser):
    """The anchors of a page, what it links to, and what it loads."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.anchors: set[str] = set()
        self.twice: list[str] = []
        self.links: list[str] = []
        self.loads: list[str] = []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        for name, value in attributes:
            if name == "id" and value:
                self.twice += [value] if value in self.anchors else []
                self.anchors.add(value)
            elif (tag, name) in LOADED and value:
                self.loads.append(value)
            elif tag == "a" and name == "href" and value:
                self.links.append(value)


def problems(site: Path) -> list[str]:
    """One line for each problem."""
    pages = {path: Page(path) for path in sorted(site.rglob("*.html"))}
    own = {path: page for path, page in pages.items() if path.relative_to(site).parts[0] not in FOREIGN}
    found = []
    for path, page in own.items():
        name = path.relative_to(site)
        found += [f"{name}: two elements have the id {anchor}" for anchor in page.twice]
        for target in page.loads + page.links:
            parts = urlsplit(target)
            if parts.scheme == "data":
                continue
            if parts.scheme or parts.netloc:
                if target in page.loads or parts.scheme not in ("https", "http"):
                    found.append(f"{name}: loads {target}")
                continue
            file = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if not file.is_file():
                found.append(f"{name}: {target}: there is no such file")
            elif parts.fragment and file in pages and unquote(parts.fragment) not in pages[file].anchors:
                found.append(f"{name}: {target}: there is no such anchor")
    for path in (*site.glob("*.css"), *site.glob("*.js")):
        text = path.read_text(encoding="utf-8")
        found += [f"{path.name}: names {address}" for address in re.findall(r"https?://[^\s\"')]+|url\(|@import", text)]
    size = first_page(site, own)
    if size > LIMIT:
        found.append(f"index.html: {size:,} bytes with style and script; at most {LIMIT:,}")
    return found


def first_page(site: Path, pages: dict[Path, Page]) -> int:
    """Bytes that the first page loads, without pictures."""
    start = site / "index.html"
    loaded = [site / target for target in pages[start].loads if target.endswith((".css", ".js"))]
    return start.stat().st_size + sum(path.stat().st_size for path in loaded if path.is_file())


def main(site: Path) -> None:
    """Prints the numbers of the site, or ends with its problems."""
    found = problems(site)
    if found:
        raise SystemExit("\n".join(f"error: {line}" for line in found))
    pages = {path: Page(path) for path in site.glob("*.html")}
    links = sum(len(page.links) for page in pages.values())
    print(f"{len(pages)} pages at the top, {links:,} links; the first page has {first_page(site, pages):,} bytes")
