"""Tasks and scenes as they are changed in the page, each with an undo."""

import pytest

from tests.system.gizmos import pull_handle
from tests.system.processes import Service
from tests.system.visits import Visit


def tab(visit: Visit, name: str) -> None:
    visit.page.locator(f"#tab-{name}").click()


def rename_delete_and_undo(visit: Visit, service: Service, other: str) -> None:
    """Call the chosen task `another` Grüne Kiste, not as `other`; delete it, and bring it back in both ways."""
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
    name.fill("--")
    assert "at least one letter or digit" in name.evaluate("one => one.validationMessage")
    name.fill(other)
    name.press("Enter")
    menu.locator(f".error:has-text('there is a task {other} already')").wait_for()
    name.fill("Grüne Kiste")
    menu.get_by_text("In addresses and commands: gruene-kiste").wait_for()
    name.press("Enter")
    stands("Task another is called Grüne Kiste now.", chosen="gruene-kiste")
    assert page.locator("#task option:checked").inner_text() == "Grüne Kiste"
    assert service.station.get_task("gruene-kiste").display_name == "Grüne Kiste"
    undo()
    stands("Task Grüne Kiste is called another now.", chosen="another")
    order("Delete the task")
    stands("Task another is deleted; all of it is kept.", deleted="another")
    undo()
    stands("Task another is back.", chosen="another")
    order("Delete the task")
    stands("Task another is deleted; all of it is kept.", deleted="another")
    order("Bring back")
    stands("Task another is back.", chosen="another")


def choose_a_station(visit: Visit, counts: dict[str, int]) -> None:
    """Look at the demonstrations of this station, then of each other one, then of all, which bear their names.

    Args:
        counts: of the task's demonstrations by station, this one first.
    """
    page, rows = visit.page, visit.page.locator("ol.demonstration-list > li")
    page.locator("#station").wait_for()
    assert page.locator("#station option").all_inner_texts() == [*counts, "all stations"]
    assert page.locator("#station").input_value() == next(iter(counts))
    for name, count in counts.items():
        page.select_option("#station", name)
        visit.wait(lambda count=count: rows.count() == count)
        assert all(rows.filter(has_text=each).count() == 0 for each in counts)
    page.select_option("#station", "")
    visit.wait(lambda: rows.count() == sum(counts.values()))
    assert {name: rows.filter(has_text=name).count() for name in counts} == counts


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
    page.locator("#scene-save-name").fill("--")
    page.locator("#scene-save").click()
    message.locator(".error:has-text('at least one letter or digit')").wait_for()
    page.locator("#scene-save-name").fill("Halle 3 (Süd)")
    page.locator("#scene-save").click()
    message.get_by_text("Scene Halle 3 (Süd) is made").wait_for()
    called = {scene.name: scene.display_name for scene in service.station.scenes()}
    assert called["halle-3-sued"] == "Halle 3 (Süd)"
    page.locator("#scene-remove").click()
    message.get_by_text("Scene Halle 3 (Süd) is removed").wait_for()
    assert "halle-3-sued" not in [scene.name for scene in service.station.scenes()]
    message.get_by_role("button", name="Undo").click()
    message.get_by_text("Scene Halle 3 (Süd) is back").wait_for()
    assert len(service.station.get_scene("halle-3-sued").scene.obstacles) == 3
    assert page.locator("#scene-name").input_value() == "halle-3-sued"
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
