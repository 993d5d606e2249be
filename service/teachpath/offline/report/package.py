"""The review package as one HTML file: the page's modules, the viewer and the answers inlined; it fetches nothing."""

from __future__ import annotations

import base64
import os
import secrets
from datetime import UTC, datetime
from pathlib import Path
from typing import Final

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from teachpath import __version__
from teachpath.errors import UnusableInput
from teachpath.io.documents import to_document
from teachpath.live.preview.asset_paths import VIEWER_STYLES, viewer_files, web_files
from teachpath.live.preview.page_modules import data_address, import_map
from teachpath.offline.report.review import Review

SHEETS: Final = ("vendor/uplot/uPlot.min.css", "style.css", "report/report.css")
REPLACED_MODULES: Final = {"transport.js": "report/archive.js"}  # requests are answered from the package


def write_package(review: Review, file: Path) -> int:
    """Write a review into a file that is not there yet, whole or not at all; return its size in bytes.

    Raises:
        UnusableInput: the file is there already, or cannot be written.
    """
    content = package_html(review).encode()
    part = file.with_name(f"{file.name}.{os.getpid()}.part")
    try:
        part.write_bytes(content)
        os.link(part, file)  # fails when it is there already, unlike a rename
    except FileExistsError:
        raise UnusableInput(f"{file} is there already; give another place with --into, or move it away") from None
    except OSError as error:
        raise UnusableInput(f"cannot write {file}: {error.strerror}; give another place with --into") from None
    finally:
        part.unlink(missing_ok=True)
    return len(content)


def package_html(review: Review) -> str:
    """Return the whole package."""
    web, viewer = web_files(), viewer_files()
    nonce = secrets.token_urlsafe(16)
    template = _environment(web / "report").get_template("report.html")
    return template.render(
        **_headings(review),
        nonce=nonce,
        policy=_policy(nonce),
        icon=data_address(_text(web / "icon.svg"), "image/svg+xml"),
        sheets=[data_address(_text(web / sheet), "text/css") for sheet in SHEETS],
        modules=import_map("report/report.js", lambda path: _text(web / path), instead=REPLACED_MODULES),
        viewer=data_address(_text(viewer / "dist" / "main.min.js"), "text/javascript"),
        licences=_licences(web, viewer),
        archive={path: to_document(record) for path, record in review.answers.items()},
        arm=base64.b64encode(review.arm).decode(),
    )


def _environment(folder: Path) -> Environment:
    environment = Environment(loader=FileSystemLoader(folder), autoescape=True, undefined=StrictUndefined)
    environment.policies["json.dumps_kwargs"] = {"allow_nan": False, "separators": (",", ":")}
    return environment


def _headings(review: Review) -> dict[str, str]:
    learned = review.run.learned
    made = datetime.fromtimestamp(review.run.created_ns / 1e9, UTC)
    count, found = len(learned.demonstrations), len(learned.clusters)
    return {
        "title": f"{review.run.task}: {found} {'way' if found == 1 else 'ways'}",
        "facts": f"{count} demonstrations, run {review.run.id} of {made:%Y-%m-%d %H:%M} UTC, mode {learned.mode}, "
        f"teachpath {__version__}",
    }


def _policy(nonce: str) -> str:
    """Return the content security policy: only what bears the nonce runs or gives style, and nothing is fetched."""
    styles = " ".join(f"'{digest}'" for digest in VIEWER_STYLES)
    return "; ".join(
        (
            "default-src 'none'",
            f"script-src 'nonce-{nonce}'",
            f"style-src 'nonce-{nonce}' {styles}",
            "img-src data: blob:",
            "base-uri 'none'",
            "form-action 'none'",
        )
    )


def _licences(web: Path, viewer: Path) -> str:
    files = [viewer / "LICENSE", viewer / "dist" / "main.min.js.LICENSE.txt"]
    files += [web / "vendor" / name / "LICENSE.txt" for name in ("three", "uplot")]
    return "\n".join(_text(file) for file in files)


def _text(file: Path) -> str:
    return file.read_text(encoding="utf-8")
