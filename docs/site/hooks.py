"""Hooks of MkDocs: pages and files from outside of docs/, links to them, and an index that is searched without a server."""

from __future__ import annotations

import os
import posixpath
import re
from pathlib import Path
from typing import Any

from mkdocs.structure.files import File

ROOT = Path(__file__).parents[2]

#: Pages at the root of the project.
ROOT_PAGES = ("ARCHITECTURE.md", "CHANGELOG.md", "CONTRIBUTING.md")

#: The folder of the site for other files of the project that pages link to.
COPIES = "project"

LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^)\s]+)\)")
FENCE = re.compile(r"^```.*?^```", re.MULTILINE | re.DOTALL)


def slug(heading: str, separator: str) -> str:
    """The anchor of a heading, as hosts of repositories make it."""
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", separator)


def on_config(config: Any) -> Any:
    """Removes optional pages that do not exist from the navigation."""
    config.mdx_configs["toc"] = {"slugify": slug}
    missing = {page for page in config.extra["optional"] if not Path(config.docs_dir, page).is_file()}
    config.nav = without(config.nav, missing)
    return config


def without(entries: list[Any], missing: set[str]) -> list[Any]:
    """The entries of a navigation, without these pages."""
    kept: list[Any] = []
    for entry in entries:
        if isinstance(entry, dict):
            ((title, target),) = entry.items()
            if isinstance(target, list):
                entry = {title: without(target, missing)}
            elif target in missing:
                continue
        kept.append(entry)
    return kept


def on_files(files: Any, *, config: Any) -> Any:
    """Adds the pages at the root, and the files of the project that pages link to."""
    sources = [(page.src_uri, page.content_string) for page in files.documentation_pages()]
    for name in ROOT_PAGES:
        text = (ROOT / name).read_text(encoding="utf-8")
        files.append(File.generated(config, name.lower(), content=rewritten(text, name)))
        sources.append((f"../{name}", text))
    for uri, text in sources:
        for _, _, target in LINK.findall(FENCE.sub("", text)):
            path = project_path(f"docs/{uri}", target)
            if path and copied(path) and files.get_file_from_path(f"{COPIES}/{path}") is None:
                copy = (ROOT / path).read_bytes()
                files.append(File.generated(config, f"{COPIES}/{path}.txt", content=copy))
    return files


def on_page_markdown(markdown: str, *, page: Any, **_: Any) -> str:
    """Rewrites links that leave docs/, and pipes of code in tables."""
    if page.file.src_uri in {name.lower() for name in ROOT_PAGES}:
        return tables(markdown)
    return tables(rewritten(markdown, f"docs/{page.file.src_uri}"))


def project_path(page: str, target: str) -> str | None:
    """The path of a link's target in the project; None for a link to elsewhere, or within its page."""
    path = target.split("#")[0]
    if not path or "://" in target or target.startswith("mailto:"):
        return None
    return posixpath.normpath(f"{posixpath.dirname(page)}/{path}" if posixpath.dirname(page) else path)


def copied(path: str) -> bool:
    """Whether a path is that of a file outside of docs/ that is no page of the site."""
    return not path.startswith("docs/") and path not in ROOT_PAGES and (ROOT / path).is_file()


def rewritten(markdown: str, page: str) -> str:
    """The text of a page of the project with links as they are in the site."""
    place = "" if page in ROOT_PAGES else posixpath.dirname(page).removeprefix("docs").strip("/")

    def replace(found: re.Match[str]) -> str:
        image, text, target = found.groups()
        path = project_path(page, target)
        if path is None:
            return found[0]
        if not (ROOT / path).exists():
            raise SystemExit(f"error: {page}: link to {target}, but there is no {path}")
        if path.startswith("docs/"):
            new = path.removeprefix("docs/")
        elif path in ROOT_PAGES:
            new = path.lower()
        elif copied(path):
            new = f"{COPIES}/{path}.txt"
        else:
            return f"{text} (`{path}/` in the project)"  # a folder
        anchor = f"#{target.split('#')[1]}" if "#" in target else ""
        return f"{image}[{text}]({posixpath.relpath(new, place or '.')}{anchor})"

    parts = re.split(f"({FENCE.pattern})", markdown, flags=FENCE.flags)
    return "".join(part if part.startswith("```") else LINK.sub(replace, part) for part in parts)


def tables(markdown: str) -> str:
    """Pipes of code in tables, which Markdown of repositories escapes, and that of Python does not."""
    lines = markdown.split("\n")
    code = re.compile(r"`[^`]*`")
    for number, line in enumerate(lines):
        if line.startswith("|"):
            lines[number] = code.sub(lambda found: found[0].replace("\\|", "|"), line)
    return "\n".join(lines)


def on_page_context(context: dict[str, Any], *, page: Any, **_: Any) -> dict[str, Any]:
    """Tells the page of Rust whether the site has the documentation of the crates."""
    context["has_rustdoc"] = page.file.src_uri == "rust.md" and "SSCC_RUSTDOC" in os.environ
    return context


def on_post_build(config: Any) -> None:
    """Writes the index as a script, which a page that was opened as a file may load."""
    index = Path(config.site_dir, "search", "search_index.json")
    index.with_suffix(".js").write_text(f"searchIndex = {index.read_text(encoding='utf-8')};\n", encoding="utf-8")
    index.unlink()
    for sitemap in Path(config.site_dir).glob("sitemap.xml*"):
        sitemap.unlink()  # it would need an address
