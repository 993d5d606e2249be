"""Files on the page: dropped, looked at, corrected, marked on the curve, and imported all or none; then moved."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.contract.desk import csv
from tests.system.access import barriers
from tests.system.processes import Service
from tests.system.visits import Visit
from tests.unit.offline.test_file_report import dwelling, table, two_markers, two_motions

pytestmark = pytest.mark.system

CARDS = "#import-files .card.file"


@pytest.fixture
def visit(browser: Any, service: Service) -> Iterator[Visit]:
    visit = Visit(browser, service.url)
    yield visit
    visit.page.close()


def named(folder: Path, name: str, **header: str) -> Path:
    folder.mkdir()
    return table(folder, dwelling(dwells=1 if name.startswith("unsure") else 2), **header).rename(folder / name)


def until(visit: Visit, script: str) -> None:
    visit.page.wait_for_function(f"() => {script}", polling=50)


def card_says(visit: Visit, name: str, word: str) -> None:
    cards = f"[...document.querySelectorAll('{CARDS}')]"
    until(visit, f"{cards}.some((c) => c.textContent.includes('{name}') && c.textContent.includes('{word}'))")


def test_files_are_corrected_marked_and_imported_and_moved(visit: Visit, service: Service, tmp_path: Path) -> None:
    page = visit.page
    files = [
        named(tmp_path / "1", "plain.csv"),
        named(tmp_path / "2", "other.csv", header="when,a,b,c"),
        named(tmp_path / "3", "unsure.csv"),
    ]
    page.locator("#import-files input[type=file]").set_input_files(files)
    card_says(visit, "plain.csv", "clean")
    card_says(visit, "other.csv", "cannot be used")
    card_says(visit, "unsure.csv", "mark it")
    importing = page.get_by_role("button", name="Import all 3")
    assert importing.is_disabled()

    page.get_by_role("button", name="other.csv", exact=True).click()
    page.locator("#import-files details.corrections[open]").wait_for()  # where its question is answered
    for role, column in (("time", "when"), ("x", "a"), ("y", "b"), ("z", "c")):
        page.get_by_label(f"Column of {role}", exact=True).select_option(label=column)
    card_says(visit, "other.csv", "clean")

    page.get_by_role("button", name="unsure.csv", exact=True).click()
    plot = page.locator("#import-files .motion-plot")
    box = plot.bounding_box()
    assert box is not None
    for share in (0.2, 0.8):
        plot.click(position={"x": share * box["width"], "y": 0.5 * box["height"]})
    until(visit, "document.querySelectorAll('#import-files [role=slider]').length === 2")
    card_says(visit, "unsure.csv", "clean")
    assert barriers(page, "files") == []

    page.locator("#import-task").fill("filed")
    page.locator("#import-task").blur()
    until(visit, "!document.querySelector('#import-files [data-import]').disabled")
    importing.click()
    until(visit, "document.querySelector('#import-files .imported')")
    rows = service.station.demonstrations("filed")
    assert [(row.number, row.source, row.verdict) for row in rows] == [
        (number, file.name, "clean") for number, file in enumerate(files, 1)
    ]
    said = page.locator("#import-files .imported li").all_inner_texts()
    assert [text.split()[:2] for text in said] == [[str(row.number), row.source] for row in rows]
    times = np.array(service.station.trajectory(rows[2].id).times)
    whole = dwelling(dwells=1)
    assert times[-1] == pytest.approx(0.6 * 0.02 * (len(whole) - 1), abs=0.1)

    service.station.make_task("others", scene="empty")
    page.wait_for_selector("#task option[value=others]", state="attached")
    page.get_by_role("button", name="Select several").click()
    for number in (1, 2):
        page.get_by_label(f"Select demonstration {number}", exact=True).check()
    page.get_by_role("button", name="Mark good", exact=True).click()
    until(visit, "document.querySelector('#demonstrations').textContent.split('Marked good').length === 3")
    page.get_by_label("Move them to another task").select_option("others")
    until(visit, "document.querySelectorAll('#demonstrations li.discarded').length === 2")
    assert [(row.mark, row.verdict) for row in service.station.demonstrations("others")] == [("good", "clean")] * 2
    assert [bool(row.discarded_ns) for row in service.station.demonstrations("filed")] == [True, True, False]
    assert visit.said == []


def test_a_marker_is_chosen_and_a_later_motion_marked(visit: Visit, service: Service, tmp_path: Path) -> None:
    page = visit.page
    page.locator("#import-files input[type=file]").set_input_files([two_markers(tmp_path), two_motions(tmp_path)])
    card_says(visit, "markers.trc", "under “Read it otherwise”")
    assert "--" not in page.locator("#import-files").inner_text()
    page.get_by_label("Body, marker or topic").select_option("elbow")
    card_says(visit, "markers.trc", "clean")

    card_says(visit, "motions.npy", "mark it")
    page.get_by_role("button", name="motions.npy", exact=True).click()
    page.get_by_label("Motion", exact=True).select_option("2")
    until(visit, "document.querySelector('#import-files').textContent.includes('Not sure where the object')")
    for name, seconds in (("Taken at", "0.5"), ("put at", "2.0")):
        page.get_by_label(name).fill(seconds)
        page.get_by_label(name).press("Enter")
    card_says(visit, "motions.npy", "2 demonstrations, clean")
    page.locator("#import-task").fill("several")
    page.locator("#import-task").blur()
    until(visit, "!document.querySelector('#import-files [data-import]').disabled")
    page.get_by_role("button", name="Import all 2").click()
    until(visit, "document.querySelector('#import-files .imported')")
    assert [str(row.verdict) for row in service.station.demonstrations("several")] == 3 * ["clean"]
    assert visit.said == []


def test_a_file_that_is_dropped_anywhere_on_the_page_is_looked_at(visit: Visit) -> None:
    rows = "".join(f"{k * 0.02:.2f},{k / 100},0,0.5\\n" for k in range(60))
    visit.page.evaluate(
        f"""() => {{
          const dropped = new DataTransfer();
          dropped.items.add(new File(["t,x,y,z\\n{rows}"], "dropped.csv"));
          const how = {{ dataTransfer: dropped, bubbles: true, cancelable: true }};
          document.body.dispatchEvent(new DragEvent("drop", how));
        }}"""
    )
    card_says(visit, "dropped.csv", "clean")
    visit.page.get_by_role("button", name="Leave all out").click()
    until(visit, f"!document.querySelector('{CARDS}')")
    assert visit.said == []


def test_a_demonstration_is_trimmed_on_its_curve_and_laid_beside_another(visit: Visit, service: Service) -> None:
    station, page = service.station, visit.page
    for name, rise in (("one.csv", 0.0), ("two.csv", 0.001)):
        station.import_file("trimmed", csv(100, step=0.003, rise=rise).encode(), name=name, scene="empty")
    page.wait_for_selector("#task option[value=trimmed]", state="attached")
    page.select_option("#task", "trimmed")
    page.locator("#closeup-one").fill("1")
    page.locator("#closeup-one").blur()
    begin = page.get_by_role("slider", name="When the object is taken")
    begin.focus()
    for _ in range(3):
        page.keyboard.press("ArrowRight")
    trim = page.get_by_role("button", name="Trim to the marks")
    before = station.demonstrations("trimmed")[0]
    trim.click()
    page.locator("#message:has-text('Demonstration 1 goes from 0.06 to')").wait_for()
    first, last = before.trim or (before.grasp, before.release)
    assert station.demonstrations("trimmed")[0].trim == (first + 3, last)
    until(visit, "document.querySelector('[data-trim]').disabled")  # the curve as it is now
    page.locator("#message").get_by_role("button", name="Undo").click()
    visit.wait(lambda: station.demonstrations("trimmed")[0].trim is None)
    page.locator("#closeup-other").fill("2")
    page.locator("#closeup-other").blur()
    page.locator("#closeup").get_by_text("Apart by").wait_for()
    page.locator("#closeup").get_by_role("img", name="Apart by").wait_for()
    page.locator("#closeup-other").fill("77")
    page.locator("#closeup-other").blur()
    page.locator("#closeup").get_by_text("There is no demonstration 77.").wait_for()
