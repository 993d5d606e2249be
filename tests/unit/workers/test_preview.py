"""The preview: what pages are told, and that a page that does not listen costs nothing."""

import re
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import umsgpack

from teachpath.errors import UnusableInput
from teachpath.io import wire
from teachpath.io.bus import MemoryBus
from teachpath.motion.drawing import drawing
from teachpath.motion.kinematics import link_frames
from teachpath.motion.scenes import empty_scene, paper_scene
from teachpath.motion.settings import MotionSettings
from teachpath.records import JointState, Sample
from teachpath.workers.preview import WAYS, Page, Preview, PreviewSettings, commands
from teachpath.workers.preview.tree import CREDIT, SceneTree
from teachpath_proto.keys import Keys

KEYS = Keys()
HOME = np.array(MotionSettings().home)


def ignore() -> None:
    """Wake nobody."""


def split(batch: bytes | None) -> list[bytes]:
    found, at = [], 0
    while batch and at < len(batch):
        (length,) = struct.unpack_from("<I", batch, at)
        found.append(batch[at + 4 : at + 4 + length])
        at += 4 + length
    return found


def decoded(batch: bytes | None) -> list[dict[str, Any]]:
    return [umsgpack.unpackb(command) for command in split(batch)]


def take(page: Page) -> list[dict[str, Any]]:
    batch = page.take()
    page.acknowledge()
    return decoded(batch)


class Station:
    """A preview on an in-memory bus and a clock that the test turns."""

    def __init__(self) -> None:
        self.bus = MemoryBus()
        self.now = 0.0
        self.preview = Preview(
            self.bus,
            KEYS,
            drawing(),
            robot="puma560",
            home=HOME,
            to_world=lambda tracker, p: (p[0] + 1.0, p[1], p[2]) if tracker == "glove" else None,
            settings=PreviewSettings(rate=0.01),  # its own thread stays out of the way
            clock=lambda: self.now,
        )

    def publish_state(self, q: np.ndarray, *, closed: bool = False, at: tuple[float, float, float] = (0, 0, 0)) -> None:
        zero = np.zeros(6)
        state = JointState(1, 1, q, zero, zero, 0.0, 0, False, closed, at, (1.0, 0.0, 0.0, 0.0))
        self.bus.publish(KEYS.state("puma560"), wire.encode_state(state))

    def publish_sample(self, tracker: str, x: float, *, buttons: int = 0) -> None:
        sample = Sample(tracker, 1, 1, 1, (x, 0.0, 0.6), None, (), True, buttons)
        self.bus.publish(KEYS.samples(tracker), wire.sample_message(sample).SerializeToString())


# the tree


def test_replays_parents_first_and_one_value_a_property() -> None:
    tree = SceneTree()
    tree.put_object("/a/b", b"child")
    tree.put_object("/a", b"parent")
    for i in range(1000):
        tree.put_property("/a", "visible", b"%d" % i)
        tree.put_transform("/a/b", b"t%d" % i)
    sent = split(tree.attach(ignore).take())
    assert sent.index(b"parent") < sent.index(b"child")
    assert sorted(sent) == sorted([b"parent", b"child", b"999", b"t999"])


def test_a_page_that_does_not_acknowledge_gets_the_newest_later_and_nothing_grows() -> None:
    tree = SceneTree()
    stalled, lively = tree.attach(ignore), tree.attach(ignore)
    told = 0
    for i in range(5000):
        tree.put_transform("/arm", b"t%d" % i)
        tree.put_object("/trail", b"o%d" % i)
        stalled.take()
        told += len(split(lively.take()))
        lively.acknowledge()
    assert told == 10_000  # the stalled one disturbs nobody
    assert stalled.pending == 2
    stalled.acknowledge(CREDIT)
    assert split(stalled.take()) == [b"o4999", b"t4999"]


def test_credit_is_given_back_batch_by_batch() -> None:
    tree = SceneTree()
    page = tree.attach(ignore)
    sent = 0
    for i in range(10):
        tree.put_transform("/arm", b"%d" % i)
        sent += page.take() is not None
    assert sent == CREDIT
    page.acknowledge()
    assert split(page.take()) == [b"9"]
    assert page.take() is None


def test_delete_takes_the_subtree_and_all_that_was_still_to_be_sent_about_it() -> None:
    tree = SceneTree()
    page = tree.attach(ignore)
    tree.put_object("/paths/a", b"a")
    tree.put_transform("/paths/a", b"ta")
    tree.put_object("/pathsandmore", b"kept")
    tree.delete("/paths", b"gone")
    assert split(page.take()) == [b"kept", b"gone"]
    assert tree.paths() == ["/pathsandmore"]
    assert split(tree.attach(ignore).take()) == [b"kept"]


def test_what_is_shown_after_a_delete_comes_after_it() -> None:
    tree = SceneTree()
    page = tree.attach(ignore)
    tree.put_object("/paths/a", b"old")
    tree.delete("/paths", b"gone")
    tree.put_object("/paths/a", b"new")
    assert split(page.take()) == [b"gone", b"new"]


def test_a_detached_page_hears_no_more() -> None:
    tree = SceneTree()
    woken: list[int] = []
    page = tree.attach(lambda: woken.append(1))
    tree.put_object("/a", b"a")
    tree.detach(page)
    tree.put_object("/b", b"b")
    assert len(woken) == 1
    assert split(page.take()) == [b"a"]


def test_the_same_transform_twice_is_sent_once() -> None:
    tree = SceneTree()
    page = tree.attach(ignore)
    tree.put_transform("/arm", b"t")
    page.take()
    tree.put_transform("/arm", b"t")
    assert page.take() is None


# what is drawn


def test_a_new_page_gets_arm_and_object() -> None:
    preview = Station().preview
    preview.show_object(paper_scene().carried)
    sent = take(preview.attach(ignore))
    objects = {c["path"] for c in sent if c["type"] == "set_object"}
    assert "/object" in objects
    assert len([path for path in objects if path.startswith("/robot/link")]) == len(drawing())
    assert objects == set(preview.paths())


def test_the_arm_follows_the_newest_joint_state() -> None:
    station = Station()
    with station.preview as preview:
        page = preview.attach(ignore)
        take(page)
        for q1 in (0.1, 0.2, 0.3):
            station.publish_state(HOME + np.array([q1, 0, 0, 0, 0, 0]))
        preview.update()
        sent = {c["path"]: np.reshape(c["matrix"], (4, 4)).T for c in take(page)}
        frames = link_frames(HOME + np.array([0.3, 0, 0, 0, 0, 0]))
        for i in range(1, 7):
            assert np.allclose(sent[f"/robot/link{i}"], frames[i], atol=1e-5)
        station.publish_state(HOME + np.array([0.3, 0, 0, 0, 0, 1e-9]))
        preview.update()
        assert take(page) == []  # at rest nothing is sent


def test_the_object_follows_and_the_fingers_close() -> None:
    station = Station()
    with station.preview as preview:
        preview.show_object(paper_scene().carried)
        page = preview.attach(ignore)
        take(page)
        station.publish_state(HOME, closed=True, at=(0.1, 0.2, 0.7))
        preview.update()
        sent = {c["path"]: np.reshape(c["matrix"], (4, 4)).T for c in take(page)}
        assert np.allclose(sent["/object"][:3, 3], (0.1, 0.2, 0.7))
        assert {"/robot/link6/left-finger", "/robot/link6/right-finger"} <= set(sent)


def test_the_object_stays_when_the_arm_knows_of_none() -> None:
    station = Station()
    with station.preview as preview:
        preview.show_object(paper_scene().carried)
        page = preview.attach(ignore)
        take(page)
        zero = np.zeros(6)
        state = JointState(1, 1, HOME + 0.1, zero, zero, 0.0, 0, False, False, (0, 0, 0), (0, 0, 0, 0))
        station.bus.publish(KEYS.state("puma560"), wire.encode_state(state))
        preview.update()
        assert "/object" not in {c["path"] for c in take(page)}


def test_a_scene_without_an_object_shows_none() -> None:
    station = Station()
    with station.preview as preview:
        preview.show_object(paper_scene().carried)
        preview.show_object(empty_scene().carried)
        station.publish_state(HOME)
        preview.update()
        assert preview.paths("/object") == []


def test_malformed_states_and_samples_are_left_out() -> None:
    station = Station()
    with station.preview as preview:
        station.bus.publish(KEYS.state("puma560"), b"\xff\xff")
        station.bus.publish(KEYS.samples("glove"), b"\xff\xff")
        preview.update()
        assert preview.paths("/hand") == []


def test_a_hand_is_drawn_in_the_world_with_its_trail_until_it_falls_silent() -> None:
    station = Station()
    with station.preview as preview:
        page = preview.attach(ignore)
        take(page)
        for i in range(10):
            station.now += 0.02
            station.publish_sample("glove", 0.01 * i, buttons=int(i > 5))
            station.publish_sample("stranger", 0.0)
            preview.update()
        marker = [c for c in take(page) if c["path"] == "/hand/glove/marker" and c["type"] == "set_transform"]
        assert marker[-1]["matrix"][12] == pytest.approx(1.09)  # tracker 0.09, calibration + 1
        assert preview.paths("/hand") == ["/hand/glove/marker", "/hand/glove/trail"]
        station.now += PreviewSettings().hand_silence + 0.1
        preview.update()
        assert preview.paths("/hand") == []


def test_stops_listening_when_stopped() -> None:
    station = Station()
    with station.preview as preview:
        page = preview.attach(ignore)
        take(page)
    station.publish_state(HOME + 0.1)
    station.preview.update()
    assert take(page) == []


def test_the_page_uses_the_same_colours_everywhere() -> None:
    web = Path(__file__).parents[3] / "clients" / "web"
    style = dict(re.findall(r"--way-(\d): #([0-9a-f]{6});", (web / "style.css").read_text()))
    (drawn,) = re.findall(r"WAYS = \[(.*?)\]", (web / "shapes.js").read_text())
    assert [int(style[str(i)], 16) for i in range(len(WAYS))] == list(WAYS)
    assert [int(colour, 16) for colour in drawn.split(",")] == list(WAYS)


# the meshes


def outward(vertices: np.ndarray, faces: np.ndarray) -> float:
    """Signed volume of a mesh: positive when its faces look outwards."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return float(np.sum(a * np.cross(b, c))) / 6


def test_a_prism_is_closed_and_looks_outwards() -> None:
    square = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)]
    vertices, faces = commands.prism_mesh(square, 2.0)
    assert outward(vertices, faces) == pytest.approx(2.0)


def test_a_tube_keeps_its_distance_from_the_curve() -> None:
    t = np.linspace(0, 4, 120)
    spiral = np.column_stack([np.cos(t), np.sin(t), 0.2 * t])
    vertices, faces = commands.tube_mesh(spiral, 0.05)
    rings = vertices.reshape(len(spiral), -1, 3)
    assert np.allclose(np.linalg.norm(rings - spiral[:, None], axis=2), 0.05)
    length = np.sum(np.linalg.norm(np.diff(spiral, axis=0), axis=1))
    assert outward(vertices, faces) == pytest.approx(np.pi * 0.05**2 * length, rel=0.1)
    # neighbouring rings are not twisted against each other
    assert np.max(np.linalg.norm(np.diff(rings, axis=0), axis=2)) < 0.06


def test_a_straight_tube_needs_no_special_case() -> None:
    line = np.linspace([0.0, 0, 0], [0, 0, 1.0], 5)
    vertices, _ = commands.tube_mesh(line, 0.1)
    assert np.all(np.isfinite(vertices))


def test_a_cylinder_stands_upright() -> None:
    sent = umsgpack.unpackb(commands.solid("/c", "cylinder", (0.1, 0.4), pose=commands.pose_of((1.0, 2.0, 3.0))))
    matrix = np.reshape(sent["object"]["object"]["matrix"], (4, 4)).T
    assert np.allclose(matrix @ [0, 0.2, 0, 1], [1, 2, 3.2, 1])  # three.js's y end is up


def test_an_unknown_shape_is_refused_with_its_name() -> None:
    with pytest.raises(UnusableInput, match="/x cannot be drawn: 'cone'"):
        commands.solid("/x", "cone", (1.0,))
