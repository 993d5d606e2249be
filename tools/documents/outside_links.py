"""Takes into the site what documents link to outside docs/: other documents as pages, files as they are."""

from __future__ import annotations

import posixpath
import re
from pathlib import Path
from typing import Final

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

ROOT: Final = Path(__file__).parents[2]
LINK: Final = re.compile(r"(\]\()([^)\s#]+)((?:#[^)\s]*)?\))")
SHOWN_SUFFIXES: Final = {".md", ".png", ".svg", ".txt"}
FOLDER: Final = "project"  # of the site, where they go; below it they lie as in the repository


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add every file that a document links to, and what those link to."""
    waiting = [(file.src_uri, Path(file.abs_src_path or "")) for file in files.documentation_pages()]
    waiting += [(item, ROOT / item.removeprefix(f"{FOLDER}/")) for item in _named_in(config.nav)]
    done = set()
    while waiting:
        uri, path = waiting.pop()
        if uri in done or not path.is_file():
            continue
        done.add(uri)
        if uri.startswith(f"{FOLDER}/") and uri not in files.src_uris:
            files.append(File.generated(config, uri, content=path.read_bytes()))
        if path.suffix == ".md":
            linked = [_target(uri, place) for _, place, _ in LINK.findall(path.read_text())]
            waiting += [(_uri(there), there) for there in linked if there is not None]
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Let links to files of the repository lead to where they are in the site."""

    def replaced(found: re.Match[str]) -> str:
        before, place, behind = found.groups()
        there = _target(page.file.src_uri, place)
        if there is None:
            return found.group()
        uri = _uri(there)
        if there.is_dir():
            uri = next((each for each in (f"{uri}/README.md",) if each in files.src_uris), "")
            if not uri:
                return f"{before}{_way(page, _uri(ROOT / 'README.md'))})"
        return f"{before}{_way(page, uri)}{behind}"

    return LINK.sub(replaced, markdown)


def _named_in(nav: object) -> list[str]:
    """Return the documents of this folder that the navigation names."""
    if isinstance(nav, str):
        return [nav] if nav.startswith(f"{FOLDER}/") else []
    inner = nav.values() if isinstance(nav, dict) else nav if isinstance(nav, list) else ()
    return [name for each in inner for name in _named_in(each)]


def _target(uri: str, place: str) -> Path | None:
    """Return what a link leads to in the repository; None for another machine, or nothing that is there."""
    if re.match(r"[a-z]+:", place) or place.startswith("/"):
        return None
    folder = ROOT / posixpath.dirname(uri.removeprefix(f"{FOLDER}/") if uri.startswith(f"{FOLDER}/") else f"docs/{uri}")
    there = (folder / place).resolve()
    return there if there.exists() and there.is_relative_to(ROOT) else None


def _uri(there: Path) -> str:
    """Return the place of a file of the repository in the site."""
    inside = there.relative_to(ROOT).as_posix()
    if inside.startswith("docs/"):
        return inside.removeprefix("docs/")
    text = "" if there.is_dir() or there.suffix in SHOWN_SUFFIXES else ".txt"  # a browser shows it instead of saving it
    return f"{FOLDER}/{inside}{text}"


def _way(page: Page, uri: str) -> str:
    return posixpath.relpath(uri, posixpath.dirname(page.file.src_uri) or ".")
