"""Whatever a person has entered or chosen in the page stays, also when the service answers late or out of turn."""

from collections.abc import Callable, Iterator
from dataclasses import asdict
from typing import Any

import numpy as np
import pytest

from teachpath_client import Link, Tracker
from teachpath_client.models import Run
from tests.system.answers import Late
from tests.system.editors import Desk
from tests.system.processes import Service
from tests.system.test_station import record

pytestmark = pytest.mark.system

TASK = "late"
ANY_SEGMENT = "[^/]*"
A_WHILE = 1000  # [ms] in which what must not happen would show, on most machines; where it does not, nothing fails


@pytest.fixture(scope="module")
def learned(service: Service) -> Run:
    """A run of a task with three ways; the first of them has a plan and a second version, the others are as learned."""
    record(service, TASK, 12)
    run = service.station.learn(TASK)
    service.station.plan(run.learned.paths[0].id)
    return run


@pytest.fixture(scope="module")
def paths(learned: Run) -> list[str]:
    return [path.id for path in learned.learned.paths]


@pytest.fixture
def desk(browser: Any, service: Service, learned: Run) -> Iterator[Desk]:
    """A page of its own for every test, in which the task is chosen."""
    desk = Desk(browser, service.url)
    choose(desk, TASK)
    yield desk
    desk.page.close()


def choose(desk: Desk, task: str) -> None:
    desk.page.wait_for_selector(f"#task option[value='{task}']", state="attached")
    desk.page.select_option("#task", task)
    desk.wait(
        lambda: bool(desk.page.evaluate(f"teachpath.state().task === '{task}' && teachpath.state().runs !== null"))
    )


def store(service: Service, path: str) -> int:
    """Save another version of a path, as somebody else does; return its number."""
    newest = service.station.versions(path)[-1].number
    curve = asdict(service.station.get_version(path, newest).path.curve)
    curve["control_points"][2][2] += 0.001
    return service.station.save_version(path, curve, base=newest, branch="main", author="somebody").number


# the task


def test_the_scene_of_a_new_task_stays_chosen(desk: Desk) -> None:
    scene = desk.page.locator("#new-scene")
    desk.click("#new-task-button")
    desk.wait(lambda: scene.locator("option").count() > 1)
    desk.page.keyboard.press("Escape")
    scenes = Late(desk, "scenes")
    desk.click("#new-task-button")
    scenes.wait()
    assert scene.input_value() == "paper"  # the task's
    scene.select_option("empty")
    scenes.let_go()
    assert scene.input_value() == "empty"


def test_a_popover_that_was_left_opens_nothing_any_more(desk: Desk, service: Service) -> None:
    made = Late(desk, "tasks/left", "PUT")
    desk.click("#new-task-button")
    desk.page.get_by_label("Name", exact=True).fill("left")
    desk.wait(lambda: desk.page.locator("#new-scene").input_value() != "")
    desk.page.get_by_role("button", name="Make the task").click()
    made.wait()
    desk.page.keyboard.press("Escape")
    desk.click("#tab-run")
    made.let_go()
    desk.page.wait_for_selector("#task option[value=left]", state="attached")
    assert desk.page.locator("#task").input_value() == TASK
    assert desk.page.locator("#tab-run").get_attribute("aria-selected") == "true"


def test_a_new_task_stays_chosen_beside_a_list_from_before_it(desk: Desk, service: Service) -> None:
    lists = Late(desk, "tasks")
    service.station.make_task("somebody-elses")
    lists.wait()
    desk.click("#new-task-button")
    desk.page.get_by_label("Name", exact=True).fill("mine")
    desk.wait(lambda: desk.page.locator("#new-scene").input_value() != "")
    with desk.page.expect_response(lambda answer: answer.request.method == "PUT"):
        desk.page.get_by_role("button", name="Make the task").click()
    lists.let_go()
    lists.over()
    desk.wait(lambda: desk.page.locator("#task").input_value() == "mine")


def test_the_scene_that_is_drawn_is_that_of_the_task_that_is_chosen(browser: Any, service: Service) -> None:
    service.station.make_task("bare", scene="empty")
    desk = Desk(browser, service.url)
    choose(desk, "bare")
    scenes = Late(desk, "scenes")
    desk.page.reload()
    desk.page.wait_for_selector(f"#task option[value='{TASK}']", state="attached")
    desk.page.select_option("#task", TASK)
    scenes.wait(2)
    scenes.let_go(-1)
    scenes.over()
    desk.wait(lambda: "/scene/box" in desk.paths())
    desk.page.close()


def test_an_error_is_not_wiped_away_by_what_was_asked_before_it(desk: Desk) -> None:
    dendrogram = Late(desk, f"tasks/{TASK}/runs/{ANY_SEGMENT}/dendrogram")
    desk.page.reload()
    dendrogram.wait()
    desk.click("#new-task-button")
    desk.page.get_by_label("Name", exact=True).fill(TASK)
    desk.page.get_by_role("button", name="Make the task").click()
    error = desk.page.locator("#message .error")
    desk.wait(lambda: "already" in (error.text_content() or ""))
    dendrogram.let_go()
    assert error.count() == 1


# ways


def test_a_cut_can_be_moved_only_when_it_is_that_of_the_run(desk: Desk) -> None:
    dendrogram = Late(desk, f"tasks/{TASK}/runs/{ANY_SEGMENT}/dendrogram")
    desk.page.reload()
    desk.click("#tab-ways")
    slider = desk.page.get_by_label("height of the cut")
    dendrogram.wait()
    assert slider.is_disabled()
    dendrogram.let_go()
    desk.wait(slider.is_enabled)


def test_a_card_shows_the_newest_version_of_a_path(desk: Desk, service: Service, paths: list[str]) -> None:
    known = Late(desk, f"paths/{paths[2]}")
    store(service, paths[2])
    known.wait(1)
    newest = store(service, paths[2])
    known.wait(2)

    def shown() -> int:
        return int(desk.page.evaluate(f"teachpath.state().latestVersions['{paths[2]}'].version"))

    known.let_go(-1)
    desk.wait(lambda: shown() == newest)
    known.over()
    assert shown() == newest


# edit


def test_the_path_that_was_chosen_last_is_edited(desk: Desk, paths: list[str]) -> None:
    desk.open(paths[0])
    versions = Late(desk, f"paths/{paths[1]}/versions")
    desk.click(f"#edit-path [data-path='{paths[1]}']")
    versions.wait()
    desk.click(f"#edit-path [data-path='{paths[0]}']")
    versions.let_go()
    assert desk.ask("editor.draft.path") == paths[0]


def test_a_gesture_is_a_step_of_the_path_that_it_was_made_on(desk: Desk, paths: list[str]) -> None:
    desk.open(paths[0])
    before = desk.curve()
    versions = Late(desk, f"paths/{paths[1]}/versions")
    desk.click(f"#edit-path [data-path='{paths[1]}']")
    versions.wait()
    x, y = desk.project("editor.draft.curve.control_points[2]")
    desk.page.mouse.move(x, y)
    desk.page.mouse.down()
    desk.page.mouse.move(x + 30, y - 20, steps=3)
    desk.until("editor.draft.edited")
    versions.over()
    desk.until(f"editor.draft.path === '{paths[1]}'")
    desk.page.mouse.move(x + 60, y - 40, steps=3)
    desk.page.mouse.up()
    assert not desk.ask("editor.draft.edited")
    desk.open(paths[0])
    assert not np.array_equal(desk.curve().control_points, before.control_points)
    desk.click("#edit-undo")
    np.testing.assert_array_equal(desk.curve().control_points, before.control_points)


def test_a_version_that_is_taken_is_taken_into_its_own_path(desk: Desk, paths: list[str]) -> None:
    desk.open(paths[0])
    version = Late(desk, f"paths/{paths[0]}/versions/1")
    desk.unfold("#edit-versions")
    desk.page.get_by_role("button", name="edit version 1").click()
    version.wait()
    desk.page.locator(f"#edit-path [data-path='{paths[1]}']").click()
    desk.until(f"editor.draft.path === '{paths[1]}'")
    before = desk.curve()
    version.let_go()
    assert desk.ask("editor.draft.path") == paths[1]
    assert desk.curve().control_points.tobytes() == before.control_points.tobytes()


def test_what_is_edited_and_typed_while_a_version_is_saved_is_kept(desk: Desk, paths: list[str]) -> None:
    desk.open(paths[1])
    number = desk.ask("editor.draft.base.number")
    saved = Late(desk, f"paths/{paths[1]}/versions", "POST")
    desk.drag(2, 20, -15)
    desk.page.fill("#edit-note", "higher")
    desk.save()
    saved.wait()
    desk.drag(3, 20, -15)
    later = desk.curve()
    desk.page.fill("#edit-note", "and wider")
    desk.page.fill("#edit-branch", "wide")
    saved.over()
    desk.until(f"editor.draft.base.number === {number + 1}")
    assert desk.ask("editor.draft.edited")
    assert desk.curve().control_points.tobytes() == later.control_points.tobytes()
    assert desk.page.input_value("#edit-note") == "and wider"
    assert desk.page.input_value("#edit-branch") == "wide"
    desk.wait(lambda: "Saved as version" in desk.page.inner_text("#message"))  # and it is said


def test_typed_numbers_stay_while_the_degree_is_raised(desk: Desk, paths: list[str]) -> None:
    desk.open(paths[1])
    desk.page.select_option("#edit-points", "2")
    degree = desk.ask("editor.draft.curve.degree")
    raised = Late(desk, "curves/elevate", "POST")
    desk.unfold("#edit-knots")
    desk.click("#edit-elevate")
    raised.wait()
    desk.page.fill("#edit-u", "0.123")
    desk.page.fill("#edit-x", "456.7")  # not entered yet
    raised.over()
    desk.until(f"editor.draft.curve.degree === {degree + 1}")
    assert desk.page.input_value("#edit-u") == "0.123"
    assert desk.page.input_value("#edit-x") == "456.7"


def test_the_versions_to_compare_stay_chosen_when_another_one_is_saved(
    desk: Desk, service: Service, paths: list[str]
) -> None:
    second = store(service, paths[0])
    desk.open(paths[0])
    desk.until(f"editor.versions.length === {second}")
    lists = Late(desk, f"paths/{paths[0]}/versions")
    third = store(service, paths[0])
    lists.wait()
    desk.unfold("#edit-versions")
    desk.page.select_option("#edit-first", str(second))
    desk.page.select_option("#edit-second", "1")
    lists.over()
    desk.until(f"editor.versions.length === {third}")
    assert desk.page.input_value("#edit-first") == str(second)
    assert desk.page.input_value("#edit-second") == "1"


# run


def test_nobody_starts_the_plan_of_the_path_that_was_looked_at_before(desk: Desk, paths: list[str]) -> None:
    desk.click("#tab-run")
    desk.page.wait_for_selector("button.hold:not([disabled])")
    plans = Late(desk, f"paths/{paths[1]}/plans")
    desk.click("#tab-edit")
    desk.click(f"#edit-path [data-path='{paths[1]}']")
    plans.wait()
    desk.click("#tab-run")
    assert desk.page.locator("#arm button.hold").is_disabled()
    assert "Looking for" in desk.page.inner_text("#preview")
    plans.over()
    desk.wait(lambda: "no certified motion yet" in desk.page.inner_text("#preview"))


def test_a_preview_of_a_tab_that_was_left_does_not_open(desk: Desk) -> None:
    motion = Late(desk, f"plans/{ANY_SEGMENT}/motion")
    desk.click("#tab-run")
    desk.page.get_by_role("button", name="Preview", exact=True).click()
    motion.wait()
    desk.click("#tab-ways")
    motion.let_go()
    assert desk.page.evaluate("teachpath.previewGhost()") is None


def series(height: float) -> dict[str, Any]:
    """What an execution did: stand with one joint at an angle."""
    rows = [[0.0, height, 0.0, 0.0, 0.0, 0.0]] * 2
    still = [[0.0] * 6] * 2
    return {
        "times": [0.0, 1.0],
        "positions": rows,
        "velocities": still,
        "tracking_error": [0.0, 0.0],
        "lateness": [0.0, 0.0],
        "gripper_closed": [False, False],
        "object": [],
    }


def test_the_execution_that_was_chosen_last_is_shown_again(desk: Desk) -> None:
    status = {"execution": "", "state": "ended", "reason": "", "duration": 1.0}
    done = [{"id": name, "plan": "", "created_ns": 0, "status": {**status, "execution": name}} for name in ("a", "b")]
    desk.page.route("**/api/v1/executions?*", lambda route: route.fulfill(json=done))
    asked: list[Any] = []
    desk.page.route("**/series?**", lambda route: asked.append(route))
    desk.page.reload()
    desk.click("#tab-run")
    for count, name in enumerate(("a", "b"), start=1):
        desk.click(f"#replay [data-execution={name}]")
        desk.wait(lambda count=count: len(asked) == count)
    for route in reversed(asked):
        route.fulfill(json=series(0.5 if "/a/" in route.request.url else 1.0))
        desk.wait(lambda: desk.page.evaluate("teachpath.replayGhost() !== null"))
    desk.page.evaluate("fetch('/api/v1/station').then(() => new Promise(requestAnimationFrame))")
    assert desk.page.locator("#replay [data-execution=b]").get_attribute("aria-pressed") == "true"


def test_control_that_was_taken_anew_is_not_lost_with_the_former_one(desk: Desk) -> None:
    beats = Late(desk, "lease/beat", "POST")
    desk.click("#tab-run")
    take, give = (desk.page.get_by_role("button", name=name) for name in ("Take control", "Give it back"))
    take.click()
    beats.wait()
    give.click()
    take.click()
    give.wait_for()
    beats.let_go(status=409, json={"error": "Conflict", "detail": "it has lapsed"})
    assert give.count() == 1
    beats.over()
    give.click()
    take.wait_for()


def test_no_arm_is_led_for_a_tab_that_was_left(desk: Desk) -> None:
    orders: list[str] = []
    desk.page.on("request", lambda asked: orders.append(asked.url) if "teleoperation" in asked.url else None)
    robot = Late(desk, "robot")
    desk.click("#tab-run")
    desk.page.get_by_role("button", name="Lead the arm").click()
    robot.wait(2)  # the plots ask too
    desk.click("#tab-ways")
    robot.over()
    desk.page.wait_for_timeout(A_WHILE)
    assert orders == []
    desk.click("#tab-run")
    desk.wait(desk.page.get_by_role("button", name="Lead the arm").is_enabled)


def test_the_calibration_of_a_live_hand_stays_chosen(desk: Desk, service: Service) -> None:
    def measured(*names: str) -> Callable[[Any], None]:
        return lambda route: route.fulfill(json=[{"calibration": {"name": name}} for name in names])

    desk.click("#tab-run")
    desk.page.route("**/api/v1/calibrations", measured("lab"))
    with Link(service.endpoint) as link:
        first = Tracker(link, "glove-a")
        desk.page.locator("#teleop-hand option[value='glove-a']").wait_for(state="attached")
        desk.page.select_option("#teleop-hand", "glove-a")
        desk.page.locator("#teleop-calibration option[value=lab]").wait_for(state="attached")
        desk.page.select_option("#teleop-calibration", "lab")
        desk.page.unroute("**/api/v1/calibrations")
        desk.page.route("**/api/v1/calibrations", measured("bench", "lab"))
        second = Tracker(link, "glove-b")
        desk.page.locator("#teleop-calibration option[value=bench]").wait_for(state="attached")
        assert desk.page.input_value("#teleop-calibration") == "lab"
        del first, second


# demonstrate


def test_nothing_is_recorded_for_a_task_that_was_left(desk: Desk, service: Service) -> None:
    service.station.make_task("bare", scene="empty")
    desk.page.wait_for_selector("#task option[value=bare]", state="attached")
    desk.click("#tab-demonstrate")
    task = Late(desk, f"tasks/{TASK}")
    desk.page.get_by_role("button", name="Show it here").click()
    task.wait()
    desk.page.select_option("#task", "bare")
    task.over()
    desk.page.wait_for_timeout(A_WHILE)
    assert desk.page.locator("html").get_attribute("data-session") == ""
    assert service.station.recordings(TASK) == service.station.recordings("bare") == []
