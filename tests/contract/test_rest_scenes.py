"""Scenes over REST: made, changed, copied, removed and read back; what is refused; and what becomes of plans."""

from collections.abc import Iterator
from typing import Any

import pytest

from teachpath.errors import PathRefused
from teachpath.motion.collision.builtin_scenes import paper_scene
from teachpath.records import CertificateQuery
from tests.contract.desk import Desk, refused
from tests.contract.test_rest_work import planned

BOX = {"name": "case", "kind": "box", "size": [0.1, 0.2, 0.3], "position": [0.5, 0.3, 0.65]}
CUBE = [[x, y, z] for x in (0, 40) for y in (0, 40) for z in (0, 40)]


@pytest.fixture
def name(desk: Desk) -> Iterator[str]:
    """A scene that is gone after the test, so that others find those of the settings."""
    yield "bench"
    if desk.get("/scenes/bench").status_code == 200:
        assert desk.send("DELETE", "/api/v1/scenes/bench").json()["removed"]


def names(desk: Desk) -> list[str]:
    return [scene["name"] for scene in desk.get("/scenes").json()]


def test_a_scene_is_made_changed_copied_removed_and_every_version_read_back(desk: Desk, name: str) -> None:
    address = f"/scenes/{name}"
    made = desk.put(address, {"obstacles": [BOX], "base": newest(desk, name), "author": "Ada", "note": "first"}).json()
    assert (made["author"], made["note"], made["removed"]) == ("Ada", "first", False)
    mesh = BOX | {"name": "cube", "kind": "mesh", "size": [0.001], "vertices": CUBE, "file": "cube.stl"}
    can = BOX | {"name": "can", "mass": 0.35}
    more = {"obstacles": [BOX, mesh], "carried": can, "floor": -0.1, "base": made["number"]}
    changed = desk.put(address, more).json()
    assert changed["number"] == made["number"] + 1
    saved = desk.get(address).json()
    assert saved["version"] == changed
    assert desk.put(address, {k: v for k, v in saved["scene"].items() if k != "name"}).json() == changed
    assert len(saved["scene"]["obstacles"][1]["vertices"]) == 36
    assert (saved["scene"]["carried"]["mass"], saved["scene"]["obstacles"][0]["mass"]) == (0.35, None)
    first = desk.get(f"{address}/versions/{made['number']}").json()
    assert [shape["name"] for shape in first["scene"]["obstacles"]] == ["case"]
    assert desk.get(f"{address}/versions").json()[:2] == [changed, made]
    assert name in names(desk)
    refused(desk.put(address, {"base": made["number"]}), 409, "this change began at version")
    removed = desk.send("DELETE", f"/api/v1{address}").json()
    assert (removed["number"], removed["removed"]) == (changed["number"] + 1, True)
    assert name not in names(desk)
    refused(desk.get(address), 404, f"bring it back with: teachpath scene restore {name}")
    refused(desk.put("/tasks/gone", {"scene": name}), 422, "body.scene: there is no scene 'bench' any more")
    assert desk.get(f"{address}/versions").json()[0] == removed


def newest(desk: Desk, name: str) -> int:
    """Return the number of the newest version of a scene that a test before may have removed."""
    versions = desk.get(f"/scenes/{name}/versions")
    return versions.json()[0]["number"] if versions.status_code == 200 else 0


def test_a_copy_is_another_scene(desk: Desk, name: str) -> None:
    copy = f"copy-{newest(desk, name)}"  # a name is copied to once
    desk.put(f"/scenes/{name}", {"obstacles": [BOX]})
    answer = desk.post(f"/scenes/{name}/copies", {"name": copy})
    assert (answer.status_code, answer.headers["location"]) == (201, f"/api/v1/scenes/{copy}")
    assert desk.get(f"/scenes/{copy}").json()["scene"]["obstacles"][0]["name"] == "case"
    refused(desk.post(f"/scenes/{name}/copies", {"name": copy}), 409, f"there is, or was, a scene {copy}")
    refused(desk.post(f"/scenes/{name}/copies", {"name": "a b"}), 422, "cannot name a scene")
    refused(desk.post("/scenes/moon/copies", {"name": "b"}), 404, "there is no scene 'moon'; known: paper, empty")
    desk.send("DELETE", f"/api/v1/scenes/{copy}")


@pytest.mark.parametrize(
    ("body", "sentence"),
    [
        ({"obstacles": [BOX | {"kind": "cone"}]}, "body.obstacles.0.kind"),
        ({"obstacles": [BOX | {"sise": [1]}]}, "there is no field 'sise'; did you mean size?"),
        ({"obstacles": [BOX | {"size": [0.1]}]}, "a box has 3 lengths over 0"),
        ({"obstacles": [BOX | {"size": [0.1, 0, 0.1]}]}, "body.obstacles.0.size.1"),
        ({"obstacles": [BOX | {"position": [11, 0, 0]}]}, "body.obstacles.0.position.0"),
        ({"obstacles": [BOX | {"orientation": [0, 0, 0, 0]}]}, "no value of obstacles.0.orientation"),
        ({"obstacles": [BOX | {"color": -1}]}, "body.obstacles.0.color"),
        ({"obstacles": [BOX, BOX]}, "there are two bodies case"),
        ({"obstacles": [BOX | {"mass": 1.0}]}, "case in scene bench has a mass; only the carried object has one"),
        ({"carried": BOX | {"mass": 0.0}}, "body.carried.mass"),
        ({"carried": BOX | {"mass": 101.0}}, "body.carried.mass"),
        ({"obstacles": [BOX], "carried": BOX}, "there are two bodies case"),
        ({"carried": BOX | {"name": ""}}, "cannot name a body"),
        ({"keep_in": [BOX | {"kind": "sphere", "size": [1]}]}, "keep-in zone case in scene bench is a sphere"),
        ({"obstacles": [BOX | {"kind": "mesh", "size": [1]}]}, "a mesh, and only a mesh, has a file"),
        ({"obstacles": [BOX | {"kind": "mesh", "size": [1], "vertices": [[0, 0, 0]] * 9}]}, "mesh case is flat"),
        ({"obstacles": [BOX | {"kind": "mesh", "size": [1], "vertices": [[0, 0]]}]}, "body.obstacles.0.vertices.0"),
        ({"obstacles": [BOX] * 201}, "body.obstacles"),
        ({"floor": "low"}, "body.floor"),
        ({"base": -1}, "body.base"),
        ([], "body"),
    ],
)
def test_a_scene_that_cannot_be_is_a_sentence_and_leaves_nothing(desk: Desk, body: Any, sentence: str) -> None:
    before = newest(desk, "bench")
    refused(desk.put("/scenes/bench", body), 422, sentence)
    assert newest(desk, "bench") == before
    refused(desk.put("/scenes/a%20b", {}), 422, "cannot name a scene")


def test_a_mesh_file_comes_back_as_its_hull_and_nothing_of_it_is_kept(desk: Desk, name: str) -> None:
    before = desk.station.transfers.names()
    corners = [[x + 1 / 3, y, z] for x, y, z in [*CUBE, [20, 20, 20]]]
    content = "".join(f"v {x} {y} {z}\n" for x, y, z in corners).encode()
    hull = desk.post("/meshes", json=None, content=content, params={"name": "cube.obj"}).json()
    assert (hull["file"], len(hull["vertices"])) == ("cube.obj", 36)
    assert {tuple(corner) for corner in hull["vertices"]} == {(round(x, 5), y, z) for x, y, z in corners[:-1]}
    mesh = BOX | {"kind": "mesh", "size": [0.001]} | hull
    assert desk.put(f"/scenes/{name}", {"obstacles": [mesh]}).is_success
    saved = desk.get(f"/scenes/{name}").json()["scene"]["obstacles"][0]
    assert {tuple(corner) for corner in saved["vertices"]} == {tuple(corner) for corner in hull["vertices"]}
    twice = mesh | {"vertices": saved["vertices"] * 2, "max_pieces": 2, "pieces": [12, 12]}
    assert desk.put(f"/scenes/{name}", {"obstacles": [twice]}).is_success
    assert desk.get(f"/scenes/{name}").json()["scene"]["obstacles"][0].items() >= twice.items()
    for file, sent, sentence in (
        ("cube.step", content, "mesh cube.step ends in '.step'; known: .glb, .obj, .ply, .stl"),
        ("flat.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n", "mesh flat.obj is flat"),
        ("torn.stl", b"short", "mesh torn.stl is torn"),
        ("empty.stl", b"", "empty.stl: the file is empty"),
        ("", content, "name"),
    ):
        refused(desk.post("/meshes", json=None, content=sent, params={"name": file}), 422, sentence)
    refused(desk.post("/meshes", json=None, content=content), 422, "name")
    assert desk.station.transfers.names() == before


def test_what_is_not_there_is_named(desk: Desk) -> None:
    for place in ("moon", "moon/versions", "moon/versions/1"):
        refused(desk.get(f"/scenes/{place}"), 404, "there is no scene 'moon'; known: paper, empty")
    refused(desk.get("/scenes/paper/versions/7"), 404, "no version 7 of scene 'paper'; it has 1 to 1")
    refused(desk.send("DELETE", "/api/v1/scenes/moon"), 404, "there is no scene 'moon'")


def test_a_plan_of_a_former_version_is_refused_and_holds_again_with_its_scene(desk: Desk, name: str) -> None:
    station = desk.station
    desk.put(f"/scenes/{name}", {"obstacles": [BOX]})
    plan = station.store.plan(planned(station, f"plan-of-scene-{newest(desk, name)}", station.scenes.get(name)))
    assert plan.certificate.signature
    query = CertificateQuery(plan.id, plan.certificate.signature.mac)
    station.certificate_status.check(query)
    desk.put(f"/scenes/{name}", {"obstacles": [BOX | {"position": [0.5, 0.3, 0.66]}]})
    with pytest.raises(PathRefused, match=f"scene {name} has changed since {plan.id} was certified"):
        station.certificate_status.check(query)
    desk.put(f"/scenes/{name}", {"obstacles": [BOX]})
    station.certificate_status.check(query)
    desk.send("DELETE", f"/api/v1/scenes/{name}")
    with pytest.raises(PathRefused, match="there is no scene 'bench' any more"):
        station.certificate_status.check(query)


def test_a_scene_that_has_its_object_elsewhere_forgets_where_it_was_told_to_lie(desk: Desk, name: str) -> None:
    carried = BOX | {"name": "cup"}
    desk.put(f"/scenes/{name}", {"carried": carried})
    told = [0.4, 0.0, 0.6]
    desk.put(f"/scenes/{name}/object", {"position": told})
    desk.put(f"/scenes/{name}", {"carried": carried, "floor": -0.1})
    assert desk.get(f"/scenes/{name}/object").json()["position"] == told
    desk.put(f"/scenes/{name}", {"carried": carried | {"position": [0.5, 0.1, 0.65]}})
    assert desk.get(f"/scenes/{name}/object").json()["position"] == [0.5, 0.1, 0.65]


def test_the_object_stays_while_somebody_demonstrates_with_it(desk: Desk, name: str) -> None:
    body = {"carried": BOX | {"name": "cup"}}
    desk.put(f"/scenes/{name}", body)
    desk.put("/tasks/in-paper", {"scene": "paper"})
    assert desk.post("/tasks/in-paper/recording", {"tracker": "glove-scenes"}).is_success
    moved = {"carried": BOX | {"name": "block"}}
    refused(desk.put("/scenes/paper", moved), 409, "while task in-paper is recorded with its object; end the recording")
    assert desk.put(f"/scenes/{name}", body | {"floor": -0.2}).is_success
    assert desk.station.scenes.get("paper") == paper_scene()
    assert desk.post("/tasks/in-paper/recording/stop", {"tracker": "glove-scenes"}).is_success
