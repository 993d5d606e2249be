"""The review package: what it holds, that its modules are the page's, that text from outside stays text."""

import base64
import json
import re
from collections.abc import Iterator
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import pytest
import umsgpack
from typer.testing import CliRunner

from teachpath.__main__ import app
from teachpath.errors import NotFound, UnusableInput
from teachpath.io.documents import encode
from teachpath.io.store.store import Store
from teachpath.live.preview.asset_paths import web_files
from teachpath.live.preview.page_modules import import_map
from teachpath.motion.arm.model import Arm
from teachpath.offline.report import write_package
from teachpath.offline.report.package import REPLACED_MODULES, package_html
from tests.unit.offline.reviews import COUNT, HOSTILE_TEXT, learned_store, review


class Elements(HTMLParser):
    """The elements of a document, in their order, and the text in each."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.found: list[tuple[str, dict[str, str | None], str]] = []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.found.append((tag, dict(attrs), ""))

    def handle_data(self, data: str) -> None:
        if self.found:
            tag, attributes, text = self.found[-1]
            self.found[-1] = (tag, attributes, text + data)

    def text(self, key: str) -> str:
        """Return the text of the element with an id."""
        return next(text for _, attributes, text in self.found if attributes.get("id") == key)


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Store]:
    store = learned_store(str(tmp_path_factory.mktemp("report")))
    yield store
    store.close()


def modules() -> dict[str, str]:
    """Return the texts of the modules that a package imports, by their names there."""
    web = web_files()
    addresses = import_map("report/report.js", lambda path: (web / path).read_text(), instead=REPLACED_MODULES)[
        "imports"
    ]
    return {name: base64.b64decode(address.partition(",")[2]).decode() for name, address in addresses.items()}


def test_it_holds_the_answers_that_the_page_asks_for(store: Store) -> None:
    found = review(store)
    archive = json.loads(Elements(package_html(found)).text("archive"))
    assert archive == {path: json.loads(encode(record)) for path, record in found.answers.items()}
    paths = [path.id for path in found.run.learned.paths]
    trajectories = [f"demonstrations/d{i}/trajectory" for i in range(COUNT)]
    assert {*trajectories, *(f"paths/{path}" for path in paths)} < set(archive)
    assert [len(archive[f"paths/{path}/plans"]) for path in paths] == [1] + [0] * (len(paths) - 1)
    assert archive["tasks/t/jobs"][0]["outcome"] == "plan-1"
    assert found.count("motion") == 1
    assert max(len(archive[name]["positions"]) for name in trajectories) <= 150


def test_the_arm_and_its_object_are_drawn_by_the_views_own_commands(store: Store) -> None:
    batch, drawn = review(store).arm, set()
    while batch:
        length = int.from_bytes(batch[:4], "little")
        drawn.add(umsgpack.unpackb(batch[4 : 4 + length])["path"].split("/")[1])
        batch = batch[4 + length :]
    assert drawn == {"robot", "object"}


def test_its_modules_are_the_files_of_the_page_but_for_the_names_that_they_import() -> None:
    found = modules()
    for name, text in found.items():
        path = REPLACED_MODULES.get(name.removeprefix("page/"), name.removeprefix("page/"))
        bare = re.compile(r'"(?:page/|\.{1,2}/)[^"]*?(\w+\.(?:esm\.)?js)"')
        assert bare.sub(r'"\1"', text) == bare.sub(r'"\1"', (web_files() / path).read_text())
        assert not re.search(r'\b(from|import) "\.', text)
        assert not re.search(r"(?<![#.\w])fetch\(", text)  # its transport asks nobody
    imported = {name for text in found.values() for name in re.findall(r'"(page/[^"]+)"', text)}
    assert imported | {"page/report/report.js"} == set(found)
    shared = {"dendrogram", "likelihood_plots", "path_card", "plan_preview", "selection_table"}
    assert {f"page/panels/{name}.js" for name in shared} | {"page/tube_geometry.js", "page/meshes.js"} < set(found)


def test_text_from_outside_stays_text(store: Store) -> None:
    found = review(store)
    task = replace(
        found, run=replace(found.run, task=HOSTILE_TEXT)
    )  # as no name may be, but the template must not rely on it
    plain, hostile = Elements(package_html(found)), Elements(package_html(task))
    assert [tag for tag, _, _ in hostile.found] == [tag for tag, _, _ in plain.found]
    assert json.loads(hostile.text("archive"))[f"tasks/t/runs/{found.run.id}"]["learned"]["notes"] == [HOSTILE_TEXT]
    assert next(text for tag, _, text in hostile.found if tag == "title").startswith(HOSTILE_TEXT)


def test_only_what_the_package_itself_brings_may_run(store: Store) -> None:
    found = Elements(package_html(review(store))).found
    policy = next(attributes["content"] or "" for _, attributes, _ in found if "http-equiv" in attributes)
    nonce = re.search(r"script-src 'nonce-([\w-]+)';", policy)
    assert nonce
    assert "default-src 'none'" in policy
    assert "unsafe" not in policy
    scripts = [attributes for tag, attributes, _ in found if tag == "script"]
    data = [one["id"] for one in scripts if one.get("type") in ("application/json", "text/plain")]
    assert data == ["archive", "arm"]
    assert [one.get("nonce") for one in scripts if "id" not in one] == [nonce[1]] * 3
    assert nonce[1] not in package_html(review(store))  # another one each time: no text can know it
    addresses = [one[name] or "" for _, one, _ in found for name in ("src", "href") if name in one]
    assert all(address.startswith("data:") for address in addresses)


def test_a_plan_for_another_arm_shows_its_certificate_and_no_motion(store: Store) -> None:
    found = review(store, arm=Arm.of_variant("armstrong-khatib-burdick"))
    assert "plans/plan-1" in found.answers
    assert found.count("motion") == 0


def test_a_run_is_found_by_its_id_too_and_what_is_missing_is_named(store: Store) -> None:
    assert review(store, "run-1").run.id == review(store).run.id
    with pytest.raises(NotFound, match="there is no run 'run-9'"):
        review(store, "run-9")
    with pytest.raises(NotFound, match="nothing was learned of task unlearned yet"):
        review(store, "unlearned")


def test_a_file_that_is_there_stays_as_it_is(store: Store, tmp_path: Path) -> None:
    (tmp_path / "r.html").write_text("mine")
    with pytest.raises(UnusableInput, match="is there already"):
        write_package(review(store), tmp_path / "r.html")
    with pytest.raises(UnusableInput, match="cannot write"):
        write_package(review(store), tmp_path / "none" / "r.html")
    assert [file.name for file in tmp_path.iterdir()] == ["r.html"]
    assert (tmp_path / "r.html").read_text() == "mine"


def test_export_writes_a_package_of_a_whole_run_only(tmp_path: Path) -> None:
    learned_store(str(tmp_path / "data")).close()
    (tmp_path / "file").write_text("mine")
    refusals = [
        (["unlearned"], NotFound, "nothing was learned of task unlearned yet"),
        (["t", "--into", str(tmp_path / "file")], UnusableInput, "cannot make"),
    ]
    for words, kind, sentence in refusals:
        into = [] if "--into" in words else ["--into", str(tmp_path / "out")]
        data = str(tmp_path / "data")
        refused = CliRunner().invoke(app, ["export", "report", *words, *into, "--data", data]).exception
        assert isinstance(refused, kind)
        assert sentence in str(refused)
    assert not list((tmp_path / "out").iterdir())
