"""The editor in the page on a real service: what it evaluates, drags, undoes and takes in numbers."""

import re
from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

import numpy as np
import pytest

from teachpath.io.documents import from_document
from teachpath.nurbs import Curve
from tests.system.access import barriers
from tests.system.editors import Desk, U
from tests.system.processes import Service
from tests.system.test_station import record

pytestmark = pytest.mark.system

TASK = "edited"


@pytest.fixture(scope="module")
def paths(service: Service) -> list[str]:
    """Learn the ways of a task, of which each test edits one."""
    record(service, TASK, 12)
    return [path.id for path in service.station.learn(TASK).learned.paths]


@pytest.fixture
def desks(browser: Any, service: Service) -> Iterator[Any]:
    opened: list[Desk] = []

    def open_(path: str) -> Desk:
        opened.append(Desk(browser, service.url, path))
        return opened[-1]

    yield open_
    for desk in opened:
        desk.close()


def test_the_page_evaluates_a_curve_as_the_service_does(desks: Any, service: Service, paths: list[str]) -> None:
    desk, rng = desks(paths[0]), np.random.default_rng(5)
    script = "async ([curve, u]) => (await import('/web/nurbs.js')).evaluateCurve(curve, u)"
    for degree, count in ((1, 2), (2, 9), (3, 20), (5, 8), (7, 30)):
        inner = np.sort(rng.choice(np.repeat(np.linspace(0.1, 0.9, 17), degree), count - degree - 1, replace=False))
        curve = {
            "degree": degree,
            "knots": [*[0.0] * (degree + 1), *inner.tolist(), *[1.0] * (degree + 1)],
            "control_points": rng.uniform(-1, 1, (count, 3)).tolist(),
            "weights": rng.uniform(0.1, 10, count).tolist(),
        }
        u = [*U.tolist(), *inner.tolist()]
        theirs = np.array(service.station.call("POST", "/curves/evaluate", {"curve": curve, "u": u}))
        assert np.abs(np.array(desk.page.evaluate(script, [curve, u])) - theirs).max() <= 1e-9


def test_a_control_point_is_dragged_taken_back_and_dragged_again(desks: Any, paths: list[str]) -> None:
    desk = desks(paths[0])
    before = desk.curve()
    at = desk.project("editor.draft.curve.control_points[2]")
    desk.drag(2, 40, -30)
    after = desk.curve()
    moved = np.linalg.norm(after.control_points - before.control_points, axis=1) > 0
    assert moved.tolist() == [i == 2 for i in range(len(moved))]
    there = desk.project("editor.draft.curve.control_points[2]")
    assert np.allclose(np.subtract(there, at), (40, -30), atol=0.5)  # it follows the pointer in the picture's plane
    desk.until("editor.feasibility.assessment || editor.feasibility.error")
    assert "assessing" not in desk.page.inner_text("#edit-feasibility")

    desk.page.locator("#view").focus()
    desk.page.keyboard.press("Control+z")
    assert desk.curve().control_points.tobytes() == before.control_points.tobytes()
    desk.page.keyboard.press("Control+Shift+z")
    assert desk.curve().control_points.tobytes() == after.control_points.tobytes()
    desk.drag(0, 40, -30)  # pinned
    assert desk.curve().control_points.tobytes() == after.control_points.tobytes()
    assert "pinned" in desk.page.inner_text("#message")

    desk.page.reload()
    desk.page.wait_for_selector("html[data-scene=ready]", state="attached")
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
    assert desk.ask("editor.draft.selected") == [3]
    desk.page.keyboard.press("ArrowRight")
    step = desk.curve().control_points[3] - before[3] - [0, 0, 0.011]
    assert np.count_nonzero(np.abs(step) > 1e-9) == 1
    desk.page.fill("#edit-y", "12,34 cm")
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


def same(one: Curve, other: Curve) -> bool:
    return one.control_points.tobytes() == other.control_points.tobytes()


def stored(service: Service, path: str) -> list[tuple[str, str, Curve]]:
    """Branch, author and curve of every version of a path."""
    versions = service.station.versions(path)
    curves = [service.station.get_version(path, v.number).path.curve for v in versions]
    return [(v.branch, v.author, from_document(Curve, asdict(c))) for v, c in zip(versions, curves, strict=True)]


def test_the_second_of_two_editors_chooses_and_no_edit_is_lost(desks: Any, service: Service, paths: list[str]) -> None:
    anna, ben = desks(paths[1]), desks(paths[1])
    for desk, name in ((anna, "anna"), (ben, "ben")):
        desk.page.fill("#edit-author", name)
    anna.drag(2, 30, -20)
    anna.save()
    anna.until("editor.draft.base.number === 2")
    ben.drag(3, -30, -20)
    mine = ben.curve()
    ben.save()
    ben.page.wait_for_selector("#conflict[open]")
    assert "anna" in ben.page.inner_text("#conflict-status")
    assert barriers(ben.page, "conflict") == []
    ben.click("#conflict button[value=theirs]")
    ben.until("editor.draft.base.number === 2")
    assert same(ben.curve(), anna.curve())
    ben.click("#edit-undo")
    assert same(ben.curve(), mine)

    anna.drag(2, 10, 10)
    anna.save()
    anna.until("editor.draft.base.number === 3")
    ben.save()
    ben.page.wait_for_selector("#conflict[open]")
    ben.page.fill("#conflict-branch", "bens")
    ben.click("#conflict button[value=mine]")
    ben.until("editor.draft.base.number === 4")
    versions = stored(service, paths[1])
    assert [version[:2] for version in versions] == [("main", ""), ("main", "anna"), ("main", "anna"), ("bens", "ben")]
    assert same(versions[2][2], anna.curve())
    assert same(versions[3][2], mine)


def moves(desk: Desk, before: Curve) -> np.ndarray:
    """How far each control point has been moved [m]."""
    return desk.curve().control_points - before.control_points


def test_several_points_are_chosen_and_pulled_along_an_axis_and_in_a_plane(desks: Any, paths: list[str]) -> None:
    desk = desks(paths[2])
    begin = desk.curve()
    last = len(begin.control_points) - 1
    desk.page.select_option("#edit-points", "2")
    desk.toggle(3)
    assert desk.ask("editor.draft.selected") == [2, 3]
    desk.pull("Z", (0, 0, 0.05))
    moved = moves(desk, begin)
    np.testing.assert_allclose(moved[[2, 3]], np.tile([0, 0, moved[2, 2]], (2, 1)), atol=1e-9)
    assert moved[2, 2] > 0.005
    assert not np.delete(moved, (2, 3), axis=0).any()
    desk.click("#edit-undo")  # one step
    assert same(desk.curve(), begin)
    desk.page.select_option("#edit-points", "2")
    desk.pull("XY", (0.05, 0.05, 0))
    moved = moves(desk, begin)
    assert np.abs(moved[2, :2]).max() > 0.005
    assert not np.delete(moved, 2, axis=0).any()
    assert moved[2, 2] == pytest.approx(0, abs=1e-9)
    desk.click("#edit-revert")
    assert same(desk.curve(), begin)

    with desk.shift():  # a box around everything
        box = desk.page.locator("#view").bounding_box()
        desk.page.mouse.move(box["x"] + 2, box["y"] + 2)
        desk.page.mouse.down()
        desk.page.mouse.move(box["x"] + box["width"] - 2, box["y"] + box["height"] - 2, steps=3)
        desk.page.mouse.up()
    assert desk.ask("editor.draft.selected") == list(range(last + 1))
    desk.page.locator("#view").focus()
    desk.page.keyboard.press("PageUp")
    assert moves(desk, begin)[:, 2] == pytest.approx([0, *[0.001] * (last - 1), 0])  # start and goal are pinned
    desk.click("#edit-undo")
    desk.page.get_by_label("unlock start and goal").check()
    desk.drag(0, 20, -10)
    moved = moves(desk, begin)
    assert np.abs(moved[0]).max() > 0.005  # with all that is chosen
    np.testing.assert_allclose(moved, np.tile(moved[0], (last + 1, 1)), atol=1e-9)
    desk.click("#edit-revert")


def test_knots_come_and_go_without_a_change_of_the_shape_and_versions_branch(desks: Any, paths: list[str]) -> None:
    desk = desks(paths[2])
    begin, count = desk.curve(), len(desk.curve().control_points)
    desk.unfold("#edit-knots")
    desk.page.fill("#edit-u", "0.37")
    desk.click("#edit-insert")
    desk.until(f"editor.draft.curve.control_points.length === {count + 1}")
    np.testing.assert_allclose(desk.curve()(U), begin(U), atol=1e-12)
    assert 0.37 in desk.curve().knots
    desk.page.select_option("#edit-knot", "0.37")
    desk.click("#edit-remove")
    desk.until(f"editor.draft.curve.control_points.length === {count}")
    np.testing.assert_allclose(desk.curve()(U), begin(U), atol=1e-6)  # what the page allows by itself
    desk.click("#edit-revert")

    desk.drag(2, 25, -15)
    mine = desk.curve()
    desk.page.fill("#edit-branch", "higher")
    desk.save()
    desk.until("editor.draft.base.number === 2 && editor.versions.length === 2")
    desk.unfold("#edit-versions")
    desk.page.get_by_role("button", name="edit version 1").click()
    desk.until("editor.draft.base.number === 1")
    assert same(desk.curve(), begin)
    desk.page.select_option("#edit-first", "1")
    desk.page.select_option("#edit-second", "2")
    desk.click("#edit-compare")
    desk.until("document.getElementById('edit-difference').textContent !== ''")
    said = desk.page.inner_text("#edit-difference")
    apart = np.linalg.norm(mine(U)[:, None] - begin(U)[None], axis=2).min(axis=1).max()
    found = re.match(r"Version 1 \(orange\) and version 2 \(pink\): they lie up to ([\d.]+) (mm|cm) apart", said)
    assert found, said
    told = float(found[1]) * {"mm": 0.001, "cm": 0.01}[found[2]]
    assert told == pytest.approx(apart, rel=0.06, abs=2e-4)  # of 301 places, in two digits


def test_an_object_and_its_goal_are_moved_and_the_path_follows(desks: Any, service: Service, paths: list[str]) -> None:
    desk, station = desks(paths[0]), service.station
    base = station.get_path(paths[0])
    ends = np.array(base.curve.control_points)[[0, -1]]
    desk.page.get_by_role("button", name="Move object and goal").click()
    desk.page.wait_for_selector("#edit-adapt[aria-pressed=true]")
    x, y = desk.project(str(ends[0].tolist()))
    desk.page.mouse.move(x, y)
    desk.page.mouse.down()
    desk.page.mouse.move(x + 12, y - 8, steps=6)
    desk.page.mouse.up()
    start = [float(desk.page.input_value(f"#edit-start-{axis}")) / 1000 for axis in "xyz"]
    assert np.linalg.norm(np.subtract(start, ends[0])) > 0.005
    assert start[2] == pytest.approx(ends[0][2], abs=1e-4)  # on its level
    assert "one place only" in desk.page.inner_text("#edit-adapted")  # while it is moved, not only once it is saved
    desk.page.fill("#edit-goal-x", f"{1000 * ends[1][0] + 30:.1f}")
    desk.page.keyboard.press("Tab")
    try:
        desk.page.get_by_role("button", name="Adapt and certify").click()
        desk.until(f"editor.draft.base.number === {base.version + 1}")
        desk.page.wait_for_selector("#edit-certified :is(.good, .failed)")
        adapted = station.get_path(paths[0])
        points = np.array(adapted.curve.control_points)[[0, -1]]
        np.testing.assert_allclose(points, [start, ends[1] + [0.03, 0, 0]], atol=1e-4)
        assert list(station.get_object("paper").position) == pytest.approx(start, abs=1e-4)
        assert "one place only" in desk.page.inner_text("#edit-adapted")
    finally:
        station.reset_object("paper")
