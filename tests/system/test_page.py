"""The page on a real service: readable for everybody, nothing from elsewhere, ways chosen, back after a restart."""

import itertools
import re
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any

import httpx
import pytest
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from teachpath.io.documents import from_document
from teachpath.nurbs import Curve
from teachpath_client.models import Run
from tests.system.access import barriers
from tests.system.gizmos import pull_handle
from tests.system.keyboard import tell_by_keyboard
from tests.system.operators import Operator
from tests.system.packages import Package
from tests.system.processes import Service, run
from tests.system.test_station import record
from tests.system.test_view import Visit
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


def tab(visit: Visit, name: str) -> None:
    visit.page.locator(f"#tab-{name}").click()


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
        for name in ("events", "new-task", "task-menu"):
            page.locator(f"#{name}-button").click()
            found += barriers(page, f"{name}, {scheme}")
            page.keyboard.press("Escape")
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
    rename_delete_and_undo(visit, service)
    edit_the_scene(visit, service)
    page.select_option("#task", TASK)
    page.reload()
    page.wait_for_selector("html[data-scene=ready]", state="attached")
    assert page.locator("#task").input_value() == TASK


def rename_delete_and_undo(visit: Visit, service: Service) -> None:
    """Rename the chosen task `another` and undo that, then delete it, and bring it back in each of the two ways."""
    page, menu, name = visit.page, visit.page.locator("#task-menu"), visit.page.locator("#other-task-name")

    def stands(said: str, *, chosen: str = "", deleted: str = "") -> None:
        page.locator(f"#message:has-text('{said}')").wait_for()
        newest = service.station.tasks()[-1].name  # which is chosen when the chosen one is gone
        visit.wait(lambda: page.locator("#task").input_value() == (chosen or newest) and not menu.is_visible())
        assert [task.name for task in service.station.tasks(archived=True)] == [deleted] * bool(deleted)

    def undo() -> None:
        page.locator("#message").get_by_role("button", name="Undo").click()

    def order(button: str) -> None:
        page.locator("#task-menu-button").click()
        menu.get_by_role("button", name=button).click()

    page.locator("#task-menu-button").click()
    name.fill("two words")
    assert "cannot name a task" in name.evaluate("one => one.validationMessage")
    name.fill(TASK)
    name.press("Enter")
    menu.locator(".error:has-text('there is a task seen already')").wait_for()
    name.fill("renamed")
    name.press("Enter")
    stands("Task another is called renamed now.", chosen="renamed")
    undo()
    stands("Task renamed is called another now.", chosen="another")
    order("Delete the task")
    stands("Task another is deleted; all of it is kept.", deleted="another")
    undo()
    stands("Task another is back.", chosen="another")
    order("Delete the task")
    stands("Task another is deleted; all of it is kept.", deleted="another")
    order("Bring back")
    stands("Task another is back.", chosen="another")


def edit_the_scene(visit: Visit, service: Service) -> None:
    """Add a box and a mesh to the scene `empty`, and save them; undo that, save another scene, and remove it."""
    page, message = visit.page, visit.page.locator("#message")
    tab(visit, "scene")
    page.wait_for_selector("#scene-state:has-text('This is version 1, of the settings')")
    assert page.locator("#scene-name").input_value() == "empty"  # that of the task
    page.select_option("#shape-kind", label="a box")
    page.locator("#shape-add").click()
    enter(visit, "#shape-position-x", "432.1")
    visit.wait(lambda: visit.place("/scene/box/<object>")[0, 3] == pytest.approx(0.4321))
    drag_the_shape(visit)
    for field in ("#shape-size-2", "#scene-floor"):
        enter(visit, field, "-20000")
        message.locator(".error:has-text('-20000 must be a number from')").wait_for()
    enter(visit, "#scene-floor", "-50")
    add_a_mesh(visit)
    assert len(service.station.get_scene("empty").scene.obstacles) == 1  # only the page knows of it
    page.locator("#scene-save").click()
    message.get_by_text("Saved as version 2 of scene empty").wait_for()
    scene = service.station.get_scene("empty").scene
    box, part = scene.obstacles[1:]
    assert (scene.floor, box.name, box.kind, part.name, part.kind) == (-0.05, "box", "box", "part", "mesh")
    assert ([*part.position, *part.size], len(part.vertices)) == (pytest.approx([0.58, -0.02, 0.5, 0.001]), 36)
    assert [*box.position, *box.size] == pytest.approx([0.4321, 0.0, 0.55, 0.1, 0.1, 0.1])
    message.get_by_role("button", name="Undo").click()
    message.get_by_text("Scene empty is as it was before").wait_for()
    assert len(service.station.get_scene("empty").scene.obstacles) == 1
    page.locator("#scene-undo:enabled").click()
    page.locator("#scene-save-name").fill("a b")
    page.locator("#scene-save").click()
    message.locator(".error:has-text('cannot name a scene')").wait_for()
    page.locator("#scene-save-name").fill("mine")
    page.locator("#scene-save").click()
    message.get_by_text("Scene mine is made").wait_for()
    assert "mine" in [scene.name for scene in service.station.scenes()]
    page.locator("#scene-remove").click()
    message.get_by_text("Scene mine is removed").wait_for()
    assert "mine" not in [scene.name for scene in service.station.scenes()]
    message.get_by_role("button", name="Undo").click()
    message.get_by_text("Scene mine is back").wait_for()
    assert len(service.station.get_scene("mine").scene.obstacles) == 3
    assert page.locator("#scene-name").input_value() == "mine"
    tab(visit, "run")  # the view shows what the task is done in again
    visit.wait(lambda: not any(path.startswith("/scene/box") for path in visit.paths()))


def drag_the_shape(visit: Visit) -> None:
    """Drag the chosen box along y by its arrow, and take that back."""
    page = visit.page
    places = [page.locator(f"#shape-position-{axis}") for axis in "xyz"]
    before = [place.input_value() for place in places]
    visit.draws_when_at_rest()  # the arrows are where they are drawn
    pull_handle(visit, "teachpath.shapeDrag().gizmo", "Y", (0.0, 0.1, 0.0))
    page.locator("#scene-undo[title='Undo moving box']").wait_for()
    after = [place.input_value() for place in places]
    assert float(after[1]) > float(before[1])
    assert after[::2] == before[::2]
    page.locator("#scene-undo").click()
    visit.wait(lambda: places[1].input_value() == before[1])


def add_a_mesh(visit: Visit) -> None:
    """Add a cube of 40 mm whose corner is the origin of its file."""
    page = visit.page
    cube = "".join(f"v {x} {y} {z}\n" for x in (0, 40) for y in (0, 40) for z in (0, 40)).encode()
    page.select_option("#shape-kind", label="a mesh from a file")
    with page.expect_file_chooser() as chooser:
        page.locator("#shape-add").click()
    chooser.value.set_files({"name": "part.obj", "mimeType": "model/obj", "buffer": cube})
    page.locator("#message").get_by_text("part.obj is 40 × 40 × 40 mm").wait_for()
    visit.wait(lambda: any(path.startswith("/scene/part") for path in visit.paths()))


def enter(visit: Visit, field: str, value: str) -> None:
    visit.page.locator(field).fill(value)
    visit.page.locator(field).press("Enter")


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


def test_after_a_restart_of_the_service_the_page_shows_the_truth_again(browser: Any, tmp_path: Path) -> None:
    with Service(tmp_path / "data") as service:
        learn(service, TASK)
        visit = Visit(browser, service.url)
        choose(visit, TASK)
        service.process.terminate()
        assert service.wait() == 0
    page = visit.page
    page.wait_for_selector("html[data-connection=lost][data-events=lost]", state="attached")
    visit.wait(lambda: "No connection to the service" in page.locator("#connection").inner_text())
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
    with Service(service.data, ports=service.ports) as again:
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
    for name, width in itertools.product(("demo", "x" * 64), (360, 390, 600, 860, 1024, 1920)):
        page.evaluate("name => document.querySelector('#task').replaceChildren(new Option(name))", name)
        page.set_viewport_size({"width": width, "height": 420})
        box = page.locator("#stop").bounding_box()
        place = (width - box["x"] - box["width"], box["y"], box["width"])  # from the right and from above
        assert place == (16.0, 8.0, 140.0), (width, box)
        assert box["height"] >= 44.0, (width, box)
        at = [box["x"] + box["width"] / 2, box["y"] + box["height"] / 2]
        assert page.evaluate("([x, y]) => document.elementFromPoint(x, y).id", at) == "stop", width
        page.evaluate("scrollTo(0, document.documentElement.scrollHeight)")  # a long panel on a phone
        assert page.evaluate(HIDDEN_TABS) == [], width
