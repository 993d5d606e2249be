"""The page's files: compressed, not sent twice, and every module announced by the page itself."""

import gzip
import re
from pathlib import Path

import pytest
from starlette.requests import Request

from teachpath.api.page_files import PRELOAD, PageFiles
from teachpath.live.preview.asset_paths import viewer_files, web_files
from teachpath.live.preview.page_modules import imported_modules

LARGEST_PAGE = 600_000  # bytes over the line


def request(**headers: str) -> Request:
    named = [(name.replace("_", "-").encode(), value.encode()) for name, value in headers.items()]
    return Request({"type": "http", "headers": named})


def test_a_file_is_sent_once_and_again_when_it_has_changed(tmp_path: Path) -> None:
    file, files = tmp_path / "a.js", PageFiles({"X-Of": "all"})
    file.write_text("let a = 1;\n" * 200)
    first = files.answer(request(accept_encoding="gzip"), file, "text/javascript")
    assert gzip.decompress(bytes(first.body)) == file.read_bytes()
    assert (first.headers["x-of"], first.headers["content-encoding"]) == ("all", "gzip")
    again = files.answer(request(if_none_match=first.headers["etag"]), file, "text/javascript")
    assert (again.status_code, bytes(again.body), again.headers["x-of"]) == (304, b"", "all")
    assert bytes(files.answer(request(), file, "text/javascript").body) == file.read_bytes()
    file.write_text("let b = 22;\n" * 200)
    assert files.answer(request(if_none_match=first.headers["etag"]), file, "text/javascript").status_code == 200


def test_a_file_that_is_gone_is_told(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        PageFiles({}).answer(request(), tmp_path / "none.js", "text/javascript")


def test_the_page_announces_every_module_that_it_imports() -> None:
    root = web_files()
    page = bytes(PageFiles({}).answer(request(), root / "index.html", "text/html", entry="page.js").body).decode()
    announced = re.findall(r'<link rel="modulepreload" href="web/([^"]+)">', page)
    assert announced == imported_modules("page.js", lambda path: (root / path).read_text())
    assert {"page.js", "panels/run.js", "vendor/three/three.js"} <= set(announced)
    assert PRELOAD not in page


def test_the_whole_page_is_small_over_the_line() -> None:
    root, files = web_files(), PageFiles({})
    names = imported_modules("page.js", lambda path: (root / path).read_text())
    sheets = ["style.css", "editor/editor.css", "vendor/uplot/uPlot.min.css", "icon.svg", "index.html"]
    sent = [root / name for name in [*names, *sheets]] + [viewer_files() / "dist" / "main.min.js"]
    sizes = {file.name: len(files.answer(request(accept_encoding="gzip"), file, "text/plain").body) for file in sent}
    assert sum(sizes.values()) < LARGEST_PAGE, sizes
