"""The editor in the page on a real service: drag, undo, knots, numbers, conflict, save, certify; the arm follows."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from geomdl import exchange as geomdl_exchange
from typer.testing import CliRunner, Result

from teachpath.__main__ import app
from tests.system.editors import SLOW, Desk, U, executed, same_shape
from tests.system.processes import Service
from tests.system.test_station import record

pytestmark = pytest.mark.system

TASK = "edited"


@pytest.fixture(scope="module")
def paths(service: Service) -> list[str]:
    """Learn the ways of a task, of which each test edits one."""
    record(service, TASK, 12, speed=8.0)
    job = service.job(service.call("POST", f"/tasks/{TASK}/jobs", {"kind": "learn"})["id"], seconds=120)
    run = service.call("GET", f"/tasks/{TASK}/runs/{job['outcome']}")["learned"]
    return [path["id"] for path in run["paths"]]


@pytest.fixture
def desks(browser: Any, service: Service) -> Iterator[Any]:
    opened: list[Desk] = []

    def open_(path: str) -> Desk:
        opened.append(Desk(browser, service, path))
        return opened[-1]

    yield open_
    for desk in opened:
        said = desk.said
        desk.page.close()
        assert [line for line in said if "409" not in line] == []  # a browser itself notes a refused request


def test_the_page_evaluates_a_curve_as_the_service_does(desks: Any, service: Service, paths: list[str]) -> None:
    desk, rng = desks(paths[0]), np.random.default_rng(5)
    script = "async ([curve, u]) => (await import('/web/basis.js')).evaluate(curve, u)"
    for degree, count in ((1, 2), (2, 9), (3, 20), (5, 8), (7, 30)):
        inner = np.sort(rng.choice(np.repeat(np.linspace(0.1, 0.9, 17), degree), count - degree - 1, replace=False))
        curve = {
            "degree": degree,
            "knots": [*[0.0] * (degree + 1), *inner.tolist(), *[1.0] * (degree + 1)],
            "control_points": rng.uniform(-1, 1, (count, 3)).tolist(),
            "weights": rng.uniform(0.1, 10, count).tolist(),
        }
        u = [*U.tolist(), *inner.tolist()]
        theirs = np.array(service.call("POST", "/curves/evaluate", {"curve": curve, "u": u}))
        assert np.abs(np.array(desk.page.evaluate(script, [curve, u])) - theirs).max() <= 1e-9


def test_a_control_point_is_dragged_taken_back_and_dragged_again(desks: Any, paths: list[str]) -> None:
    desk = desks(paths[0])
    before = desk.curve()
    at = desk.ask("teachpath.project(editor.draft.curve.control_points[2])")
    desk.drag(2, 40, -30)
    after = desk.curve()
    moved = np.linalg.norm(after.control_points - before.control_points, axis=1) > 0
    assert moved.tolist() == [i == 2 for i in range(len(moved))]
    there = desk.ask("teachpath.project(editor.draft.curve.control_points[2])")
    assert np.allclose(np.subtract(there, at), (40, -30), atol=0.5)  # it follows the pointer in the picture's plane
    desk.until("editor.verdict.assessment || editor.verdict.refusal")
    assert "looking" not in desk.page.inner_text("#edit-verdict")

    desk.page.locator("#view").focus()
    desk.page.keyboard.press("Control+z")
    assert desk.curve().control_points.tobytes() == before.control_points.tobytes()
    desk.page.keyboard.press("Control+Shift+z")
    assert desk.curve().control_points.tobytes() == after.control_points.tobytes()
    desk.drag(0, 40, -30)  # pinned
    assert desk.curve().control_points.tobytes() == after.control_points.tobytes()
    assert "pinned" in desk.page.inner_text("#message")

    desk.page.reload()
    desk.page.wait_for_selector("html[data-scene=ready]", state="attached", timeout=SLOW)
    desk.open(paths[0])
    assert desk.curve().control_points.tobytes() == after.control_points.tobytes()
    desk.click("#edit-undo")
    assert desk.curve().control_points.tobytes() == before.control_points.tobytes()


def test_every_edit_can_be_made_by_keyboard_and_in_numbers(desks: Any, paths: list[str]) -> None:
    desk = desks(paths[0])
    before = desk.curve().control_points
    desk.page.select_option("#edit-points", ["2", "3"])
    desk.page.locator("#view").focus()
    desk.page.keyboard.press("PageUp")
    desk.page.keyboard.press("Shift+PageUp")
    assert np.allclose(
        desk.curve().control_points - before, [[0, 0, 0.011 * (i in (2, 3))] for i in range(len(before))]
    )
    desk.page.keyboard.press("]")
    desk.page.keyboard.press("[")
    assert desk.ask("editor.draft.chosen") == [3]
    desk.page.keyboard.press("ArrowRight")
    step = desk.curve().control_points[3] - before[3] - [0, 0, 0.011]
    assert np.count_nonzero(np.abs(step) > 1e-9) == 1
    desk.page.fill("#edit-y", "123.4")
    desk.page.keyboard.press("Enter")
    desk.page.keyboard.press("Tab")
    assert desk.curve().control_points[3][1] == pytest.approx(0.1234)
    desk.page.fill("#edit-weight", "2.5")
    desk.page.keyboard.press("Tab")
    assert desk.curve().weights[3] == 2.5
    desk.page.fill("#edit-weight", "-1")
    desk.page.keyboard.press("Tab")
    assert desk.curve().weights[3] == 2.5
    assert "0.001 to 1000" in desk.page.inner_text("#message")
    for _ in range(6):
        desk.click("#edit-undo")
        if desk.ask("!editor.draft.edited"):
            break
    assert desk.curve().control_points.tobytes() == before.tobytes()


def test_knots_come_and_go_and_a_drag_of_twenty_points_fits_a_frame(desks: Any, paths: list[str]) -> None:
    desk = desks(paths[1])
    before = desk.curve()
    desk.page.fill("#edit-u", "0.37")
    desk.click("#edit-insert")
    desk.until(f"editor.draft.curve.control_points.length === {len(before.control_points) + 1}")
    assert 0.37 in desk.curve().knots
    assert same_shape(desk.curve(), before)
    desk.page.select_option("#edit-knot", "0.37")
    desk.click("#edit-remove")
    desk.until(f"editor.draft.curve.control_points.length === {len(before.control_points)}")
    assert same_shape(desk.curve(), before, within=1e-6)
    desk.click("#edit-elevate")
    desk.until(f"editor.draft.curve.degree === {before.degree + 1}")
    assert same_shape(desk.curve(), before, within=1e-6)
    while (count := len(desk.curve().control_points)) < 20:
        desk.page.fill("#edit-u", str(0.02 + 0.9 * (count / 21)))
        desk.click("#edit-insert")
        desk.until(f"editor.draft.curve.control_points.length === {count + 1}")
    assert same_shape(desk.curve(), before, within=1e-6)

    desk.ask("editor.stopwatch.reset()")
    desk.drag(9, 60, -60, steps=60)
    figures = desk.ask("editor.stopwatch.figures")
    print(f"\nwork a frame while dragging, 20 control points, {figures['frames']} frames [ms]: {figures['work']}")
    print(f"time between frames, drawn without a graphics card [ms]: {figures['interval']}")
    assert figures["frames"] >= 5
    assert figures["work"]["p95"] <= 16


def test_the_second_of_two_operators_chooses_and_no_edit_is_lost(
    desks: Any, service: Service, paths: list[str]
) -> None:
    path = paths[1]
    ada, bob = desks(path), desks(path)
    for desk, dx in ((ada, 25), (bob, -25)):
        desk.drag(2, dx, -20)
    theirs, mine = ada.curve(), bob.curve()
    base = ada.ask("editor.draft.base.number")
    ada.save(name="higher", author="Ada")
    ada.until(f"editor.draft.base.number === {base + 1}")
    bob.until(f"editor.versions.length === {base + 1}")  # told at once
    assert "saved meanwhile by Ada" in bob.page.inner_text("#edit-unsaved")
    bob.save(name="lower", author="Bob")
    bob.page.wait_for_selector("#conflict[open]", timeout=SLOW)
    assert "(higher)" in bob.page.inner_text("#conflict-told")
    bob.page.fill("#conflict-branch", "bobs")
    bob.click("#conflict button[value=mine]")
    bob.until(f"editor.draft.base.number === {base + 2}")
    stored = service.call("GET", f"/paths/{path}/versions")
    assert [(v["number"], v["parent"], v["branch"], v["author"]) for v in stored[-2:]] == [
        (base + 1, base, "main", "Ada"),
        (base + 2, base, "bobs", "Bob"),
    ]
    for number, curve in ((base + 1, theirs), (base + 2, mine)):
        kept = service.call("GET", f"/paths/{path}/versions/{number}")["path"]["curve"]
        assert np.array_equal(kept["control_points"], curve.control_points)

    ada.drag(3, 10, 10)
    mine = ada.curve()
    service.call("POST", f"/paths/{path}/versions", {"base": base + 1, "curve": stored_curve(service, path, base)})
    ada.save()
    ada.page.wait_for_selector("#conflict[open]", timeout=SLOW)
    ada.click("#conflict button[value=theirs]")
    ada.until(f"editor.draft.base.number === {base + 3}")
    assert not ada.ask("editor.draft.edited")
    ada.click("#edit-undo")  # mine is one step back
    assert ada.curve().control_points.tobytes() == mine.control_points.tobytes()

    ada.page.select_option("#edit-first", str(base))
    ada.page.select_option("#edit-second", str(base + 1))
    ada.click("#edit-compare")
    ada.page.wait_for_function(
        "document.getElementById('edit-difference').textContent.includes('changed: control point 3')", timeout=SLOW
    )


def stored_curve(service: Service, path: str, number: int) -> dict[str, Any]:
    curve: dict[str, Any] = service.call("GET", f"/paths/{path}/versions/{number}")["path"]["curve"]
    return curve


def test_an_edited_path_is_saved_certified_and_the_arm_follows_it(
    desks: Any, service: Service, paths: list[str]
) -> None:
    path = paths[2]
    desk = desks(path)
    learned = desk.curve()
    desk.page.select_option("#edit-points", [str(i) for i in range(1, len(learned.control_points) - 1)])
    desk.page.locator("#view").focus()
    desk.page.keyboard.press("Shift+PageUp")
    desk.page.keyboard.press("Shift+PageUp")
    edited = desk.curve()
    assert desk.page.locator("#edit-certify").is_disabled()
    desk.save(name="2 cm higher", author="Ada", note="over the box")
    desk.until("editor.draft.base.name === '2 cm higher'")
    version = desk.ask("editor.draft.base.number")
    desk.click("#edit-certify")
    desk.page.wait_for_selector("#edit-run", timeout=SLOW)
    plan = service.call("GET", f"/paths/{path}/plans")[0]
    assert plan["path_version"] == version
    desk.click("#edit-run")
    assert desk.page.locator("#tab-run").get_attribute("aria-selected") == "true"

    places = executed(service, plan["id"])
    fine = edited(np.linspace(0, 1, 4001))
    off = np.array([np.linalg.norm(fine - place, axis=1).min() for place in places])
    from_learned = np.array([np.linalg.norm(learned(U) - place, axis=1).min() for place in places])
    assert len(places) > 10
    assert off.max() < 0.003  # tracking error and the tolerance of the plan
    assert from_learned.max() > 0.01


def test_a_curve_goes_out_to_geomdl_and_comes_back_as_a_version(
    service: Service, paths: list[str], tmp_path: Path
) -> None:
    def curve(*words: str) -> Result:
        return CliRunner().invoke(app, ["curve", *words, "--url", service.url])

    path, file = paths[0], tmp_path / "curve.json"
    assert curve("export", path, "--version", "1", "--out", str(file)).exit_code == 0
    (theirs,) = geomdl_exchange.import_json(str(file))
    theirs.ctrlpts = [[x, y, z + 0.01 * (i == 2)] for i, (x, y, z) in enumerate(theirs.ctrlpts)]
    geomdl_exchange.export_json(theirs, str(file))
    done = curve("import", path, str(file), "--base", "1", "--branch", "geomdl", "--name", "by hand")
    assert "on branch geomdl" in done.output
    number = service.call("GET", f"/paths/{path}/versions")[-1]["number"]
    assert "changed: control point 3 of the second" in curve("compare", path, "1", str(number)).output
    assert "by hand" in curve("versions", path).output
    file.write_text("{}")
    assert "no curve in geomdl's JSON format" in str(curve("import", path, str(file)).exception)
