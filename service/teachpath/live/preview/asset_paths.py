"""Where the files of the page and of meshcat's viewer lie, and what a policy must allow the viewer."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import Final

from teachpath.errors import NotFound

# Hashes, for a content security policy, of the two style elements that meshcat's bundle puts into the page: its own
# (empty) one and dat.gui's.
VIEWER_STYLES: Final = (
    "sha256-47DEQpj8HBSa+/TImW+5JCeuQeRkm5NMpJWZG3hSuFU=",
    "sha256-K7kXOYqP8pf16L5/PaLZ4u9Lt5q3nTyjCvyGtO/Af2k=",
)


def viewer_files() -> Path:
    """Return the folder of meshcat's viewer: `dist/main.min.js` with its third-party notices, and `LICENSE`.

    Raises:
        NotFound: meshcat is not installed as files.
    """
    spec = importlib.util.find_spec("meshcat")
    if spec is None or not spec.submodule_search_locations:
        raise NotFound("meshcat's viewer is not installed; get it with: pip install 'teachpath[service]'")
    return Path(spec.submodule_search_locations[0]) / "viewer"


def web_files() -> Path:
    """Return the folder of the page's files: `teachpath/web` when installed, `clients/web` in a checkout.

    Raises:
        NotFound: neither is there.
    """
    here = Path(__file__).resolve()
    for folder in (here.parents[2] / "web", here.parents[4] / "clients" / "web"):
        if (folder / "index.html").is_file():
            return folder
    raise NotFound("the files of the operator's page are missing; reinstall teachpath")


def help_files() -> Path:
    """Return the folder of the built documents; there is none where nobody built them."""
    return Path(__file__).resolve().parents[2] / "help"


def has_documents() -> bool:
    """Tell whether the documents are built; they may be at any time."""
    return (help_files() / "index.html").is_file()
