"""The review package in headless Chromium, opened from its file, full of hostile text."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from teachpath.offline.report import write_package
from tests.system.packages import Package
from tests.unit.offline.reviews import COUNT, HOSTILE_TEXT, learned_store, review

pytestmark = pytest.mark.system


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("package")
    store = learned_store(str(folder / "data"))
    write_package(review(store), folder / "package with a #name?.html")
    store.close()
    return folder / "package with a #name?.html"


@pytest.fixture
def package(browser: Any, file: Path) -> Iterator[Package]:
    with Package(browser, file) as package:
        yield package


def test_ways_and_demonstrations_are_drawn_and_told(package: Package) -> None:
    page = package.page
    drawn = page.evaluate("teachpath.objectPaths()")
    ways = len(package.archive()["tasks/t/runs"][0]["paths"])
    assert ways == 2
    for layer, count in (("demonstrations", COUNT), ("paths", ways), ("deviations", 1)):
        assert sum(path.startswith(f"/{layer}/") for path in drawn) == count
    assert any(path.startswith("/robot/") for path in drawn)
    assert page.locator("#learned article").count() == ways
    assert page.locator("#cut .tree .leaf").count() == COUNT
    assert page.locator("#cut .tree .link").count() == COUNT - 1
    assert page.locator("#selection tbody tr:not(.why)").count() == COUNT
    page.wait_for_selector("#scores canvas >> nth=1")
    assert page.locator("#scores canvas").count() == 2
    for part in ("#learned article", "#cut svg", "#selection table", "#scores canvas", "#view canvas"):
        assert page.locator(part).first.is_visible()


def test_the_certified_motion_is_shown(package: Package) -> None:
    page = package.page
    page.get_by_role("button", name="See the motion of way").click()
    page.get_by_role("button", name="Preview", exact=True).click()
    segments = package.archive()["plans/plan-1/motion"]["segments"]
    begin, end = next((one["begin"], one["end"]) for one in segments if one["name"] == "on the path")
    page.locator(".player input").fill(f"{(begin + end) / 2:.2f}")
    assert page.locator(".player output").inner_text().endswith("on the path")
    assert page.locator("#certificate dd").count() == 7
    digest = package.archive()["plans/plan-1"]["certificate"]["digest"]
    assert page.locator("#certificate code").inner_text() == digest


def test_nothing_can_be_ordered_in_it(package: Package) -> None:
    page, names = package.page, set()
    for tab in ("ways", "run", "demonstrations", "origin"):
        page.locator(f"#tab-{tab}").click()
        names |= {button.strip() for button in page.locator("#panels button:visible").all_inner_texts()}
    assert names == {"choose", "chosen", "Motion", "Preview"}
    page.locator("#tab-ways").click()
    page.locator("#cut input").fill("0.999")  # one may look at another cut
    assert page.locator("#cut output").inner_text().startswith("1 way")
    assert page.locator("#cut button").all_inner_texts() == ["Put it back"]


def test_hostile_text_is_shown_as_it_is_written(package: Package) -> None:
    page = package.page
    assert page.locator("#learned .note", has_text="alert(1)").first.inner_text() == HOSTILE_TEXT
    page.locator("#tab-demonstrations").click()
    assert page.locator("#task .why").all_inner_texts() == [HOSTILE_TEXT] * COUNT
    assert page.locator("img").count() == 0


def test_what_did_not_come_with_the_package_does_not_run(package: Package) -> None:
    page = package.page
    inline = "document.createElement('script'), {textContent: 'globalThis.ran = true'}"
    page.evaluate(f"document.body.append(Object.assign({inline}))")
    address = "document.createElement('script'), {src: 'data:text/javascript,globalThis.ran = true'}"
    page.evaluate(f"document.body.append(Object.assign({address}))")
    sent = page.evaluate("fetch('http://127.0.0.2:9/').then(() => 'sent', (error) => error.message)")
    assert sent == "Failed to fetch"
    assert page.evaluate("globalThis.ran === undefined")
    assert all("Content Security Policy" in text for text in package.said)
    package.said.clear()
    package.asked.clear()


@pytest.mark.parametrize("width", [360, 700, 1280])
def test_it_fits_every_screen(package: Package, width: int) -> None:
    page = package.page
    page.set_viewport_size({"width": width, "height": 800})
    for tab in ("ways", "run", "demonstrations", "origin"):
        page.locator(f"#tab-{tab}").click()
        wide = "[...document.querySelectorAll('body, main, #panels, #tabs')].map((e) => e.scrollWidth - e.clientWidth)"
        assert max(page.evaluate(wide)) <= 0, tab
