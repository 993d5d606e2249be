"""The page on a real service: readable for everybody, nothing from elsewhere, ways chosen, back after a restart."""

import itertools
import re
import sqlite3
from collections.abc import Iterator
from contextlib import closing
from dataclasses import asdict
from pathlib import Path
from typing import Any

import httpx
import pytest
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from teachpath.io.documents import from_document
from teachpath.io.store.database_files import DATABASE
from teachpath.nurbs import Curve
from teachpath_client.models import Run
from tests.system.access import barriers
from tests.system.changes import choose_a_station, edit_the_scene, rename_delete_and_undo, tab
from tests.system.keyboard import tell_by_keyboard
from tests.system.operators import Operator
from tests.system.packages import Package
from tests.system.processes import Service, run
from tests.system.stop_places import WIDTHS, stop_faults
from tests.system.test_station import record
from tests.system.touching import calibrate_by_touch
from tests.system.visits import Visit
from tests.waiting import HANG

pytestmark = pytest.mark.system

TASK = "seen"
TABS = ("demonstrate", "ways", "edit", "run", "scene")
# Those that cannot be pressed where they are drawn.
HIDDEN_TABS = """[...document.querySelectorAll("#tabs button")].filter((tab) => {
  const { x, y, width, height } = tab.getBoundingClientRect();
  return document.elementFromPoint(x + width / 2, y + height / 2)?.closest("#tabs button") !== tab;
}).map((tab) => tab.textContent)"""
SOCKETS = ("view", "events", "joints", "trackers/page-x/samples")


def learn(service: Service, task: str) -> Run:
    """Show the paper's first experiment, learn it, and return the run."""
    record(service, task, 12)
    return service.station.learn(task)


@pytest.fixture(scope="module")
def learned(service: Service) -> Run:
    service.station.make_task("bare")  # with nothing in it
    return learn(service, TASK)


@pytest.fixture
def visit(browser: Any, service: Service, learned: Run) -> Iterator[Visit]:
    """A page of its own for every test, in which the task is chosen."""
    visit = Visit(browser, service.url, size=(1000, 600))
    choose(visit, TASK)
    yield visit
    visit.page.close()


def choose(visit: Visit, task: str) -> None:
    """Choose a task, and wait until all of it is drawn."""
    visit.page.wait_for_selector(f"#task option[value={task}]", state="attached")
    visit.page.select_option("#task", task)
    shown = f"teachpath.state().task === '{task}' && teachpath.state().runs !== null && teachpath.settled()"
    visit.page.wait_for_function(f"() => {shown}")


def test_nothing_keeps_anybody_from_the_page(visit: Visit) -> None:
    page = visit.page
    found = []
    schemes: tuple[Any, ...] = ("light", "dark")
    for scheme, task in itertools.product(schemes, (TASK, "bare")):
        page.emulate_media(color_scheme=scheme)
        choose(visit, task)
        for name in TABS:
            tab(visit, name)
            found += barriers(page, f"{task}, {name}, {scheme}")
        for name in ("events", "new-task", "task-menu") if task == TASK else ():
            page.locator(f"#{name}-button").click()
            found += barriers(page, f"{name}, {scheme}")
            page.keyboard.press("Escape")
    choose(visit, TASK)
    tab(visit, "ways")
    forced: dict[str, Any] = {"forced_colors": "active"}
    for wishes in (forced, {"forced_colors": "none", "contrast": "more"}):  # whatever the system chooses or asks for
        page.emulate_media(**wishes)
        found += barriers(page, f"{wishes}")
    assert found == []


def test_the_whole_story_is_told_by_the_keyboard_alone(visit: Visit, service: Service) -> None:
    operator = Operator(visit, service.station)
    assert tell_by_keyboard(visit, operator) < 400
    visit.wait(lambda: operator.executions()[0].status.state == "ended")
    assert operator.said == []


def test_tasks_and_scenes_are_made_and_changed_in_the_page_and_kept_through_a_reload(
    visit: Visit, service: Service
) -> None:
    page = visit.page
    for name in (TASK, "another"):
        page.locator("#new-task-button").click()
        page.get_by_label("Name", exact=True).fill(name)
        page.locator("#new-scene").select_option("empty")
        page.get_by_label("The object lies elsewhere each time").check()
        page.get_by_role("button", name="Make the task").click()
        if name == TASK:
            page.wait_for_selector("#message .error:has-text('already')")
            page.keyboard.press("Escape")
    visit.wait(lambda: page.locator("#task").input_value() == "another")
    another = service.station.get_task("another")
    assert (another.scene, another.object_at_grasp) == ("empty", True)
    rename_delete_and_undo(visit, service, TASK)
    edit_the_scene(visit, service)
    calibrate_by_touch(visit, service)
    page.select_option("#task", TASK)
    page.reload()
    page.wait_for_selector("html[data-scene=ready]", state="attached")
    assert page.locator("#task").input_value() == TASK


def test_no_request_leaves_the_machine(visit: Visit, service: Service) -> None:
    asked: list[str] = []
    visit.page.on("request", lambda request: asked.append(request.url))
    visit.page.on("websocket", lambda socket: asked.append(socket.url))
    visit.page.reload()
    visit.page.wait_for_selector("html[data-scene=ready]", state="attached")
    for name in TABS:
        tab(visit, name)
    visit.wait(lambda: len(asked) > 60)
    assert visit.said == []
    host = service.url.partition("//")[2]
    places = {url.partition("//")[2].partition("/")[0] for url in asked if not url.startswith(("data:", "blob:"))}
    assert places == {host}
    # and where a script would ask, the policy does not let it
    blocked = "fetch('http://127.0.0.2:9/').then(() => 'sent', (error) => error.message)"
    assert visit.page.evaluate(blocked) == "Failed to fetch"
    visit.wait(lambda: "violates" in " ".join(visit.said))
    inline = (
        "const s = document.createElement('script'); s.textContent = 'globalThis.ran = true'; document.head.append(s);"
    )
    visit.page.evaluate(f"(() => {{ {inline} }})()")
    assert visit.page.evaluate("globalThis.ran === undefined")


@pytest.mark.parametrize("resource", SOCKETS)
def test_a_page_from_elsewhere_gets_no_socket(service: Service, resource: str) -> None:
    address = f"{service.url.replace('http', 'ws')}/api/v1/{resource}"
    for origin in ("http://elsewhere.example", "null"):
        with pytest.raises(InvalidStatus) as refused:
            connect(address, origin=origin)  # type: ignore[arg-type]
        assert refused.value.response.status_code == 403
    with connect(address, origin=service.url):  # type: ignore[arg-type]
        pass


def test_what_is_pointed_at_in_a_table_stands_out_in_the_view_and_back(visit: Visit, learned: Run) -> None:
    tab(visit, "ways")
    one, other = learned.learned.clusters[0].members[0], learned.learned.clusters[1].members[0]
    row = visit.page.locator(f"#selection tr[data-focus='demonstrations {one}']").first
    row.hover()
    opacity = "teachpath.opacity('/demonstrations/{}')"
    visit.wait(lambda: visit.page.evaluate(f"{opacity.format(one)} > {opacity.format(other)}"))
    path = learned.learned.paths[2]
    curve = from_document(Curve, asdict(path.curve))
    seen = visit.project(str(curve([0.6])[0].tolist()))
    visit.page.locator("#tab-ways").hover()  # nothing is pointed at
    visit.wait(lambda: visit.page.evaluate(f"{opacity.format(one)} === {opacity.format(other)}"))
    visit.page.mouse.move(*seen)
    card = f"#learned article[data-focus='paths {path.id}'].focused"
    visit.page.wait_for_selector(card)
    assert visit.page.locator(".card.focused").count() == 1
    visit.page.mouse.click(*seen)
    visit.page.wait_for_selector(f"{card}.chosen")


def test_the_cut_is_dragged_to_make_fewer_ways(visit: Visit, service: Service) -> None:
    learned = learn(service, "cut")
    choose(visit, "cut")
    tab(visit, "ways")
    said = visit.page.locator("#cut output")
    visit.wait(lambda: said.inner_text().startswith("3 ways"))
    handle = visit.page.locator("#cut .cut-handle")
    handle.scroll_into_view_if_needed()
    tree, box = visit.page.locator("#cut .tree svg").bounding_box(), handle.bounding_box()
    assert tree is not None
    assert box is not None
    mouse, y = visit.page.mouse, box["y"] + box["height"] / 2
    mouse.move(box["x"] + box["width"] / 2, y)
    mouse.down()
    for x in range(round(box["x"]), round(tree["x"] + tree["width"]), 6):
        mouse.move(x, y)
        if said.inner_text().startswith("2 ways"):
            break
    mouse.up()
    classes = " ".join(
        visit.page.evaluate("[...document.querySelectorAll('#cut .link')].map((link) => link.getAttribute('class'))")
    )
    assert set(re.findall(r"way-\d", classes)) == {"way-0", "way-1"}
    visit.page.get_by_role("button", name="Make 2 ways").click()
    visit.wait(lambda: visit.page.locator("#learned article.card").count() == 2)
    newest = service.station.newest_run("cut")
    assert newest is not None
    assert max(len(cluster.members) for cluster in newest.learned.clusters) > max(
        len(cluster.members) for cluster in learned.learned.clusters
    )
    assert visit.said == []


def test_of_several_stations_one_is_chosen_and_after_a_restart_the_page_shows_the_truth_again(
    browser: Any, tmp_path: Path
) -> None:
    with Service(tmp_path / "data", TEACHPATH_STORE__STATION="cell-1") as service:
        learn(service, TASK)
        with closing(sqlite3.connect(service.data / DATABASE)) as database, database:
            database.execute("UPDATE demonstrations SET station = 'cell-2' WHERE number = 12")
        visit = Visit(browser, service.url)
        choose(visit, TASK)
        choose_a_station(visit, {"cell-1": 11, "cell-2": 1})
        service.process.terminate()
        assert service.wait() == 0
    page = visit.page
    page.wait_for_selector("html[data-connection=lost][data-events=lost]", state="attached")
    visit.wait(lambda: "No connection to the service" in page.locator("#connection").inner_text())
    assert stop_faults(page, "lost") == []
    for name in TABS:
        tab(visit, name)
        assert barriers(page, f"without the service, {name}") == []
    visit.wait(lambda: "the arm holds" in page.locator("#arm .state").inner_text())
    tab(visit, "demonstrate")
    visit.wait(lambda: "Not known" in page.locator("#recordings").inner_text())
    tab(visit, "ways")
    page.get_by_role("button", name="Learn anew").click()
    page.wait_for_selector("#message .error:has-text('Is it running?')")
    assert barriers(page, "an error is told") == []
    tab(visit, "run")
    with Service(service.data, ports=service.ports, TEACHPATH_STORE__STATION="cell-1") as again:
        again.station.make_task("made-meanwhile")
        page.wait_for_selector("html[data-connection=live][data-events=live]", state="attached")
        page.wait_for_selector("#task option[value=made-meanwhile]", state="attached")
        visit.wait(lambda: page.locator("#connection").inner_text() == "Connected")
        visit.wait(lambda: "At rest" in page.locator("#arm .state").inner_text())
        page.locator("#events-button").click()
        page.wait_for_selector("#events:has-text('The service answers again')")
        said = page.locator("#events").inner_text()
        assert said.index("The service answers again") < said.index("The service does not answer any more")
        page.close()


def test_the_review_package_answers_as_the_service_does_and_keeps_nobody_out(
    browser: Any, service: Service, learned: Run, tmp_path: Path
) -> None:
    service.station.plan(learned.learned.paths[0].id)
    data = ("--data", str(service.data))
    out = run("export", "report", TASK, "--into", str(tmp_path), *data, folder=tmp_path)
    assert out.process.returncode == 0, out.err
    assert str(tmp_path / f"{TASK}.html") in out.out
    found = []
    with Package(browser, tmp_path / f"{TASK}.html") as package:
        for name in ("ways", "run", "demonstrations", "origin"):
            package.page.locator(f"#tab-{name}").click()
            found += barriers(package.page, f"review package, {name}")
        archive = package.archive()
    assert found == []
    for path in (path for path in archive if path.startswith(("robot", "paths", "plans", "demonstrations", "tasks/"))):
        query = "?most=150" if path.endswith("trajectory") else ""
        answer = httpx.get(f"{service.url}/api/v1/{path}{query}", timeout=HANG, trust_env=False).json()
        if path.endswith("/plans"):  # all of the path, newest first; the package has the newest
            assert answer[:1] == archive[path]
        elif path.endswith(("/jobs", "/demonstrations", "/runs")):  # all of the task; the package has those of the run
            assert [one for one in answer if one["id"] in {kept["id"] for kept in archive[path]}] == archive[path]
        else:
            assert answer == archive[path], path


def test_stop_is_in_the_same_place_at_every_width_and_the_tabs_stay_in_reach(visit: Visit) -> None:
    page = visit.page
    for name in ("demo", "x" * 64):
        page.evaluate("name => document.querySelector('#task').replaceChildren(new Option(name))", name)
        assert stop_faults(page, f"connected, task {name}") == []
    for width in WIDTHS:
        page.set_viewport_size({"width": width, "height": 420})
        page.evaluate("scrollTo(0, document.documentElement.scrollHeight)")  # a long panel on a phone
        assert page.evaluate(HIDDEN_TABS) == [], width
