"""The review package as one HTML file: viewer, scene, tables and drawings inlined; it fetches nothing."""

from __future__ import annotations

import base64
import json
import os
from datetime import UTC, datetime
from html import escape
from pathlib import Path
from string import Template

from teachpath import __version__
from teachpath.errors import UnusableInput
from teachpath.live.preview.asset_paths import viewer_files, web_files
from teachpath.offline.report import figures, tables
from teachpath.offline.report.content import Review
from teachpath.offline.report.scene import frames, scene_batch
from teachpath.records import Array


def write(review: Review, file: Path, *, home: Array) -> int:
    """Write a review into a file that is not there yet, whole or not at all; return its size in bytes.

    Args:
        home: (6,) configuration in which the arm stands while nothing is played [rad].

    Raises:
        UnusableInput: the file is there already, or cannot be written.
    """
    content = html(review, home=home).encode()
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


def html(review: Review, *, home: Array) -> str:
    """Return the whole page."""
    folder = web_files() / "report"
    viewer = (viewer_files() / "dist" / "main.min.js").read_text(encoding="utf-8")
    made = datetime.fromtimestamp(review.run.created_ns / 1e9, UTC)
    learned = review.run.learned
    count, found = len(learned.demonstrations), len(learned.clusters)
    return Template((folder / "report.html").read_text(encoding="utf-8")).substitute(
        title=escape(f"{review.run.task}: {found} {'way' if found == 1 else 'ways'}"),
        facts=escape(
            f"{count} demonstrations, run {review.run.id} of {made:%Y-%m-%d %H:%M} UTC, mode {learned.mode}, "
            f"teachpath {__version__}"
        ),
        style=(folder / "report.css").read_text(encoding="utf-8"),
        ways=tables.ways(review),
        tree=figures.tree(review),
        selection=tables.selection(review),
        convergence=figures.convergence(review),
        demonstrations=tables.demonstrations(review),
        certificates=tables.certificates(review),
        provenance=tables.provenance(review),
        data=_data(review, home),
        viewer=_inline(viewer),
        script=_inline((folder / "report.js").read_text(encoding="utf-8")),
    )


def _data(review: Review, home: Array) -> str:
    motions = [
        {"path": path.id, "name": f"Way {path.cluster}", **frames(review.motions[path.id], review.arm)}
        for path in review.paths
        if path.id in review.motions
    ]
    scene = base64.b64encode(scene_batch(review, home)).decode()
    return _inline(json.dumps({"scene": scene, "motions": motions}, separators=(",", ":"), allow_nan=False))


def _inline(text: str) -> str:
    """Return a script that cannot end the element it stands in."""
    return text.replace("</", "<\\/").replace("<!--", "<\\!--")
