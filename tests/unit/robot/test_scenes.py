"""Scenes with versions: what counts, what is kept, and what no change disturbs."""

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import product
from pathlib import Path

import pytest

from teachpath.errors import Conflict, NotFound, UnusableInput
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.builtin_scenes import empty_scene, paper_scene
from teachpath.motion.collision.scene_checks import check_scene
from teachpath.motion.settings import MotionSettings
from teachpath.records import ObjectPose, Scene, Shape
from teachpath.robot.scene_preparation import MAX_TRIANGLES, prepared_scene
from teachpath.robot.scenes import Scenes
from tests.contract.rows import demonstration

PAPER, EMPTY_SCENE = paper_scene(), empty_scene()
BALL = Shape("ball", "sphere", (0.05,), (0.5, 0.1, 0.55))
CORNERS = tuple((x, y, z) for x, y, z in product((0.0, 40.0), repeat=3))
ARM = Arm.of_settings(MotionSettings())


@pytest.fixture
def store(tmp_path: Path) -> Iterator[Store]:
    store = Store(StoreSettings(str(tmp_path)))
    yield store
    store.close()


@pytest.fixture
def scenes(store: Store) -> Scenes:
    return Scenes(store.scenes, (PAPER, EMPTY_SCENE))


def lowered(scene: Scene, by: float) -> Scene:
    return replace(scene, floor=-by)


def test_scenes_of_the_settings_are_first_versions_and_every_later_one_is_read_back(
    scenes: Scenes, store: Store
) -> None:
    assert scenes.all() == [PAPER, EMPTY_SCENE]
    assert [version.number for version in scenes.versions("paper")] == [1]
    saved = [PAPER]
    for number in range(2, 5):
        saved.append(lowered(PAPER, number / 7))
        made = scenes.save(saved[-1], base=number - 1, author="Ada", note=f"{number}")
        assert (made.number, made.author, made.note) == (number, "Ada", f"{number}")
        assert scenes.get("paper") == saved[-1]
    again = Scenes(store.scenes, (PAPER, EMPTY_SCENE))
    assert [again.version("paper", number).scene for number in range(1, 5)] == saved
    assert [version.number for version in again.versions("paper")] == [4, 3, 2, 1]
    assert again.all() == [saved[-1], EMPTY_SCENE]
    for number in (0, 5, 10**9):
        with pytest.raises(NotFound, match=f"no version {number} of scene 'paper'; it has 1 to 4"):
            again.version("paper", number)


def test_what_is_saved_unchanged_is_no_version_and_leaves_the_settings_their_say(scenes: Scenes, store: Store) -> None:
    assert scenes.save(PAPER).number == 1
    assert store.scenes.names() == []
    changed = scenes.save(lowered(PAPER, 0.1))
    assert scenes.save(lowered(PAPER, 0.1)) == changed


def test_of_two_who_change_one_version_the_second_is_told(scenes: Scenes) -> None:
    scenes.save(lowered(PAPER, 0.1), base=1, author="Ada")
    with pytest.raises(Conflict, match="scene paper has version 2 by Ada, and this change began at version 1"):
        scenes.save(lowered(PAPER, 0.2), base=1)
    with pytest.raises(Conflict, match="there is no scene 'new' whose version 1 could have been changed"):
        scenes.save(Scene("new"), base=1)
    assert scenes.save(Scene("new"), base=0).number == 1


def test_a_removed_scene_is_gone_until_it_is_saved_again(scenes: Scenes) -> None:
    assert scenes.remove("paper", author="Ada").removed
    assert scenes.all() == [EMPTY_SCENE]
    for use in (scenes.get, scenes.newest, scenes.remove):
        with pytest.raises(NotFound, match="any more; bring it back with: teachpath scene restore paper"):
            use("paper")
    assert [(version.number, version.removed) for version in scenes.versions("paper")] == [(2, True), (1, False)]
    assert scenes.version("paper", 2).scene == PAPER
    with pytest.raises(Conflict, match="there is, or was, a scene paper"):
        scenes.copy("empty", "paper")
    assert scenes.save(PAPER, base=2).number == 3
    assert scenes.get("paper") == PAPER


def test_a_task_keeps_its_scene_and_a_station_one(scenes: Scenes, store: Store) -> None:
    store.ensure_task("cup", scene="paper", calibration="identity")
    with pytest.raises(Conflict, match="scene paper stays: a task keeps its scene, and this is that of cup"):
        scenes.remove("paper")
    scenes.remove("empty")
    with pytest.raises(Conflict, match="scene paper is the only one"):
        scenes.remove("paper")
    with pytest.raises(NotFound, match="there is no scene 'moon'; known: paper"):
        scenes.remove("moon")


def test_a_copy_goes_its_own_way(scenes: Scenes) -> None:
    made = scenes.copy("paper", "mine")
    assert (made.number, made.note) == (1, "copy of paper, version 1")
    scenes.save(replace(scenes.get("mine"), obstacles=(BALL,)))
    assert scenes.get("paper") == PAPER
    assert [scene.name for scene in scenes.all()] == ["paper", "empty", "mine"]
    with pytest.raises(UnusableInput, match="cannot name a scene"):
        scenes.copy("paper", "a b")


def test_what_is_in_use_stays_and_a_new_name_is_free(scenes: Scenes) -> None:
    for change in (
        lambda: scenes.save(lowered(PAPER, 1.0), use="the arm moves"),
        lambda: scenes.remove("paper", use="x"),
    ):
        with pytest.raises(Conflict, match="scene paper stays"):
            change()
    assert scenes.save(Scene("new"), use="the arm moves").number == 1
    assert scenes.get("paper") == PAPER


def test_demonstrations_keep_where_the_object_lay(scenes: Scenes, store: Store) -> None:
    assert PAPER.carried
    lay = ObjectPose(PAPER.carried.position, PAPER.carried.orientation)
    told = ObjectPose((0.4, 0.2, 0.52))
    store.ensure_task("cup", scene="paper", calibration="identity")
    for key, pose in (("was", None), ("told", told)):
        store.add_demonstration(demonstration(key, task="cup", object_pose=pose))
    scenes.save(lowered(PAPER, 0.1))
    assert store.demonstration("was").object_pose is None
    scenes.save(PAPER.with_object(ObjectPose((0.5, 0.0, 0.52))))
    assert [row.object_pose for row in store.demonstrations("cup")] == [lay, told]


def test_a_scene_in_which_was_shown_without_an_object_gets_none(scenes: Scenes, store: Store) -> None:
    store.ensure_task("wave", scene="empty", calibration="identity")
    store.add_demonstration(demonstration("hand", task="wave"))
    with pytest.raises(Conflict, match="had no object when demonstration 1 of task wave was made"):
        scenes.save(replace(EMPTY_SCENE, carried=BALL))
    assert scenes.get("empty") == EMPTY_SCENE


def test_a_scene_of_the_settings_that_counts_no_more_is_said(scenes: Scenes, store: Store) -> None:
    scenes.save(lowered(PAPER, 0.1))
    assert Scenes(store.scenes, (PAPER, EMPTY_SCENE)).notes == []
    edited = Scenes(store.scenes, (replace(PAPER, floor=-0.5), EMPTY_SCENE))
    assert edited.notes == ["scene paper of the settings counts no more: version 2, which was saved here, does"]


def test_a_mesh_becomes_its_hull_once(scenes: Scenes) -> None:
    mesh = Shape("case", "mesh", (0.001,), (0.5, 0.3, 0.5), vertices=(*CORNERS, (20.0, 20.0, 20.0)))
    prepared = prepared_scene(Scene("s", (mesh,), BALL), ARM)
    (case,) = prepared.obstacles
    assert set(case.vertices) == set(CORNERS)
    assert prepared_scene(prepared, ARM) == prepared
    pieces = replace(case, vertices=case.vertices * 2, pieces=(12, 12))
    assert prepared_scene(Scene("s", (pieces,)), ARM).obstacles == (pieces,)
    with pytest.raises(UnusableInput, match="is carried and has 2 pieces"):
        prepared_scene(Scene("s", (), pieces), ARM)
    turns = [2.0 * math.pi * k / (MAX_TRIANGLES // 4 + 2) for k in range(MAX_TRIANGLES // 4 + 2)]
    drum = tuple((math.cos(turn), math.sin(turn), z) for turn in turns for z in (0.0, 1.0))
    with pytest.raises(UnusableInput, match="simplify it"):
        prepared_scene(Scene("s", (replace(mesh, vertices=drum),)), ARM)


@pytest.mark.parametrize(
    ("shape", "sentence"),
    [
        (replace(BALL, name="a b"), "cannot name a body of scene s"),
        (replace(BALL, kind="cone"), "ball in scene s is a 'cone'; known are box, cylinder, sphere, mesh"),
        (replace(BALL, size=(0.1, 0.1)), r"has size \(0.1, 0.1\); a sphere has 1 lengths over 0"),
        (replace(BALL, orientation=(1.0, 1.0, 0.0, 0.0)), "has an orientation of length 1.41421"),
        (replace(BALL, vertices=((0.0, 0.0, 0.0),)), "a mesh, and only a mesh, has a file"),
        (replace(BALL, mass=0.2), "ball in scene s has a mass; only the carried object has one"),
        (replace(BALL, kind="mesh"), "a mesh, and only a mesh, has a file"),
        (replace(BALL, kind="mesh", vertices=CORNERS, pieces=(3,)), "ball in scene s has pieces of 3 triangles and 8"),
        (replace(BALL, kind="mesh", vertices=((0.0, 0.0, 0.0),) * 3), "mesh ball has 3 corners; a body needs 4"),
        (replace(BALL, kind="mesh", vertices=((0.0, 0.0, 0.0),) * 5), "mesh ball is flat"),
        (
            replace(BALL, kind="mesh", size=(1e-9,), vertices=CORNERS),
            "cannot be built: Error: mesh volume is too small",
        ),
    ],
)
def test_a_scene_that_cannot_be_is_a_sentence(shape: Shape, sentence: str) -> None:
    with pytest.raises(UnusableInput, match=sentence):
        prepared_scene(Scene("s", (shape,)), ARM)
    with pytest.raises(UnusableInput, match="two bodies ball in scene s"):
        prepared_scene(Scene("s", (BALL, BALL)), ARM)


def test_a_scene_is_called_anything_and_plans_of_it_hold(scenes: Scenes) -> None:
    called = replace(PAPER, display_name="Halle 3 (Süd)")
    assert scenes.save(called).number == 2
    assert scenes.save(called).number == 2
    assert scenes.get("paper").display_name == "Halle 3 (Süd)"
    assert scenes.get("paper") == PAPER  # by which a plan is out of date or not
    with pytest.raises(Conflict, match="'Halle 3 Süd' looks like the name of scene paper"):
        scenes.copy("empty", "other", display_name="Halle 3 Süd")
    scenes.copy("paper", "halle-4", display_name="Halle 4")
    assert scenes.get("halle-4").display_name == "Halle 4"
    with pytest.raises(UnusableInput, match=r"scene mixed: .* mixes Latin and Cyrillic letters"):
        check_scene(replace(PAPER, name="mixed", display_name="H\u0430lle"))
