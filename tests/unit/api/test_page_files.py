"""The page's files: compressed, not sent twice, and every module announced by the page itself."""

import gzip
import re
from pathlib import Path

import pytest
from starlette.requests import Request
from starlette.responses import Response

from teachpath.api.page_files import PRELOAD, PageFiles, without_comments
from teachpath.api.view import HEADERS, HTML, MEDIA, PART_HEADERS
from teachpath.live.preview.asset_paths import viewer_files, web_files
from teachpath.live.preview.page_modules import imported_modules

LARGEST_PAGE = 500_000  # bytes over the line, so that with what it asks of REST all stay under 600 kB


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
    root, files, parts = web_files(), PageFiles(HEADERS), PageFiles(PART_HEADERS)
    names = imported_modules("page.js", lambda path: (root / path).read_text())
    takes = request(accept_encoding="gzip")
    own = [parts.answer(takes, root / name, MEDIA[".js"], bare=not name.startswith("vendor/")) for name in names]
    sheets = ["style.css", "editor/editor.css", "vendor/uplot/uPlot.min.css", "icon.svg"]
    others = [parts.answer(takes, root / name, MEDIA[Path(name).suffix]) for name in sheets]
    viewer = parts.answer(takes, viewer_files() / "dist" / "main.min.js", MEDIA[".js"])
    page = files.answer(takes, root / "index.html", HTML, entry="page.js")
    sizes = [sent_size(answer) for answer in (*own, *others, viewer, page)]
    assert sum(sizes) < LARGEST_PAGE, sizes


def sent_size(answer: Response) -> int:
    """Size of an answer's body and headers [bytes]."""
    return len(bytes(answer.body)) + sum(len(name) + len(value) + 4 for name, value in answer.raw_headers)


def test_a_module_is_sent_without_comments_and_else_as_it_is() -> None:
    root = web_files()
    modules = [path for path in root.rglob("*.js") if "vendor" not in path.parts]
    assert modules
    for path in modules:
        whole = path.read_bytes().decode()
        bare = without_comments(whole.encode()).decode()
        lines, kept = whole.split("\n"), bare.split("\n")
        assert len(lines) == len(kept)
        code = ""
        for line, sent in zip(lines, kept, strict=True):
            if line != sent:
                assert sent == "", path
                assert line.strip().startswith(("//", "/**", "*")), (path, line)
                assert code.count("`") % 2 == 0, f"{path}: a comment's sign begins a line of a text: {line}"
            else:
                code += line
        assert not any(each.lstrip().startswith("//") for each in kept), path


def test_comments_between_code_stay() -> None:
    module = b"// about\nlet a = 1; // one\n/**\n * Two.\n */\nlet b = a /* here */ + 1;\n"
    assert without_comments(module) == b"\nlet a = 1; // one\n\n\n\nlet b = a /* here */ + 1;\n"
    cast = b"/** @type {X} */ (a).b();\nc();\n/** About. */\nd();\n"
    assert without_comments(cast) == b"/** @type {X} */ (a).b();\nc();\n\nd();\n"
