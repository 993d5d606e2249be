"""The preview: what pages are told, and that a page that does not listen costs nothing."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from teachpath.io import wire
from teachpath.io.memory_bus import MemoryBus
from teachpath.live.preview.preview import Preview
from teachpath.live.preview.scene_tree import Viewer
from teachpath.live.preview.settings import PreviewSettings
from teachpath.motion.arm.geometry import visual_solids
from teachpath.motion.arm.kinematics import link_frames
from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.builtin_scenes import empty_scene, paper_scene
from teachpath.motion.settings import MotionSettings
from teachpath.records import HandState, JointState, Phase, Pose, RecordingState, RecordingStatus
from teachpath_proto.keys import Keys
from tests.unit.live.pages import ignore, take

ARM = Arm.of_variant()

KEYS = Keys()
HOME = np.array(MotionSettings().home)


class Station:
    """A preview on an in-memory bus and a clock that the test turns."""

    def __init__(self) -> None:
        self.bus = MemoryBus()
        self.now = 0.0
        self.received = 0
        self.carried = paper_scene().carried
        self.statuses: list[RecordingStatus] = []
        self.preview = Preview(
            self.bus,
            KEYS,
            visual_solids(),
            arm=ARM,
            robot="puma560",
            home=HOME,
            statuses=lambda: self.statuses,
            settings=PreviewSettings(rate=0.01),  # its own thread stays out of the way
            clock=lambda: self.now,
        )

    def publish_state(self, q: np.ndarray, *, closed: bool = False, at: tuple[float, float, float] = (0, 0, 0)) -> None:
        zero = np.zeros(6)
        state = JointState(1, 1, q, zero, zero, 0.0, 0, False, closed, at, (1.0, 0.0, 0.0, 0.0))
        self.bus.publish(KEYS.state("puma560"), wire.encode_state(state))

    def see(self, x: float, phase: Phase = Phase.REACH, *, take: int = 1, carried: Pose | None = None) -> None:
        """Let the hand be at `x` and draw it."""
        self.now += 0.02
        self.received += 1
        hand = HandState((x, 0.0, 0.6), phase is Phase.TRANSPORT, self.received, take, carried)
        self.statuses = [
            RecordingStatus("t", "glove", RecordingState.RECORDING, phase, carried=self.carried, hand=hand)
        ]
        self.preview.update()


# what is drawn


def test_a_new_page_gets_arm_and_object() -> None:
    preview = Station().preview
    preview.show_object(paper_scene().carried)
    sent = take(preview.connect(ignore))
    objects = {c["path"] for c in sent if c["type"] == "set_object"}
    assert "/object" in objects
    assert len([path for path in objects if path.startswith("/robot/link")]) == len(visual_solids())
    assert objects == set(preview.paths())


def test_the_arm_follows_the_newest_joint_state() -> None:
    station = Station()
    with station.preview as preview:
        viewer = preview.connect(ignore)
        take(viewer)
        for q1 in (0.1, 0.2, 0.3):
            station.publish_state(HOME + np.array([q1, 0, 0, 0, 0, 0]))
        preview.update()
        sent = {c["path"]: np.reshape(c["matrix"], (4, 4)).T for c in take(viewer)}
        frames = link_frames(HOME + np.array([0.3, 0, 0, 0, 0, 0]), ARM)
        for i in range(1, 7):
            assert np.allclose(sent[f"/robot/link{i}"], frames[i], atol=1e-5)
        station.publish_state(HOME + np.array([0.3, 0, 0, 0, 0, 1e-9]))
        preview.update()
        assert take(viewer) == []  # at rest nothing is sent


def test_the_object_follows_and_the_fingers_close() -> None:
    station = Station()
    with station.preview as preview:
        preview.show_object(paper_scene().carried)
        viewer = preview.connect(ignore)
        take(viewer)
        station.publish_state(HOME, closed=True, at=(0.1, 0.2, 0.7))
        preview.update()
        sent = {c["path"]: np.reshape(c["matrix"], (4, 4)).T for c in take(viewer)}
        assert np.allclose(sent["/object"][:3, 3], (0.1, 0.2, 0.7))
        assert {"/robot/link6/left-finger", "/robot/link6/right-finger"} <= set(sent)


def test_the_object_stays_when_the_arm_knows_of_none() -> None:
    station = Station()
    with station.preview as preview:
        preview.show_object(paper_scene().carried)
        viewer = preview.connect(ignore)
        take(viewer)
        zero = np.zeros(6)
        state = JointState(1, 1, HOME + 0.1, zero, zero, 0.0, 0, False, False, (0, 0, 0), (0, 0, 0, 0))
        station.bus.publish(KEYS.state("puma560"), wire.encode_state(state))
        preview.update()
        assert "/object" not in {c["path"] for c in take(viewer)}


def test_a_scene_without_an_object_shows_none() -> None:
    station = Station()
    with station.preview as preview:
        preview.show_object(paper_scene().carried)
        preview.show_object(empty_scene().carried)
        station.publish_state(HOME)
        preview.update()
        assert preview.paths("/object") == []


def test_malformed_states_are_left_out() -> None:
    station = Station()
    with station.preview as preview:
        viewer = preview.connect(ignore)
        take(viewer)
        station.bus.publish(KEYS.state("puma560"), b"\xff\xff")
        preview.update()
        assert take(viewer) == []


def poses(viewer: Viewer, path: str) -> list[np.ndarray]:
    """Return the poses (4, 4) that the page is sent for `path`, in order."""
    sent = [c for c in take(viewer) if c["path"] == path and c["type"] == "set_transform"]
    return [np.reshape(c["matrix"], (4, 4)).T for c in sent]


def placed(viewer: Viewer, path: str) -> list[tuple[float, ...]]:
    """Return the positions of those poses."""
    return [tuple(round(v, 4) for v in pose[:3, 3].tolist()) for pose in poses(viewer, path)]


def test_a_hand_is_drawn_with_its_trail_until_it_falls_silent() -> None:
    station = Station()
    with station.preview as preview:
        viewer = preview.connect(ignore)
        take(viewer)
        for i in range(10):
            station.see(0.01 * i)
        assert placed(viewer, "/hand/glove/marker")[-1] == (0.09, 0.0, 0.6)
        assert preview.paths("/hand") == ["/hand/glove/marker", "/hand/glove/trail"]
        station.now += PreviewSettings().hand_silence + 0.1
        preview.update()
        assert preview.paths("/hand") == []


def test_the_trail_is_that_of_the_current_take() -> None:
    station = Station()
    with station.preview as preview:
        for i in range(20):
            station.see(0.01 * i)
        station.see(0.5, take=2)
        assert preview.paths("/hand") == ["/hand/glove/marker"]


def test_the_object_goes_with_the_hand_lies_where_it_was_let_go_and_goes_back() -> None:
    station, thing = Station(), paper_scene().carried
    assert thing is not None
    turned = (0.0, 1.0, 0.0, 0.0)
    with station.preview as preview:
        preview.show_object(thing)
        viewer = preview.connect(ignore)
        take(viewer)
        station.see(0.1)
        assert placed(viewer, "/object") == []
        station.see(0.2, Phase.TRANSPORT, carried=((0.3, 0.1, 0.7), turned))
        assert placed(viewer, "/object") == [(0.3, 0.1, 0.7)]
        station.publish_state(HOME, at=(9.0, 9.0, 9.0))  # the arm does not take it out of the hand
        station.see(0.2, Phase.TRANSPORT)  # not tracked for a moment
        station.see(0.3, Phase.RETURN)
        assert placed(viewer, "/object") == []
        station.see(0.3, Phase.REACH, take=2)
        assert placed(viewer, "/object") == [tuple(round(v, 4) for v in thing.position)]
        station.publish_state(HOME, at=(0.4, 0.4, 0.4))
        preview.update()
        assert placed(viewer, "/object") == [(0.4, 0.4, 0.4)]


def test_an_object_in_a_hand_that_vanishes_goes_back() -> None:
    station, thing = Station(), paper_scene().carried
    assert thing is not None
    with station.preview as preview:
        preview.show_object(thing)
        viewer = preview.connect(ignore)
        station.see(0.2, Phase.TRANSPORT, carried=((0.3, 0.1, 0.7), (1.0, 0.0, 0.0, 0.0)))
        take(viewer)
        station.now += PreviewSettings().hand_silence + 0.1
        preview.update()
        assert placed(viewer, "/object") == [tuple(round(v, 4) for v in thing.position)]


@pytest.mark.parametrize("vanishes", [False, True])
def test_a_block_that_stands_turned_goes_back_turned(vanishes: bool) -> None:
    station = Station()
    assert station.carried is not None
    station.carried = block = replace(station.carried, orientation=(np.cos(0.4), 0.0, 0.0, np.sin(0.4)))
    with station.preview as preview:
        preview.show_object(block)
        viewer = preview.connect(ignore)
        (start,) = poses(viewer, "/object")
        station.see(0.2, Phase.TRANSPORT, carried=((0.3, 0.1, 0.7), (1.0, 0.0, 0.0, 0.0)))
        (carried,) = poses(viewer, "/object")
        if vanishes:
            station.now += PreviewSettings().hand_silence + 0.1
            preview.update()
        else:
            station.see(0.3, take=2)
        (back,) = poses(viewer, "/object")
        assert not np.allclose(carried[:3, :3], start[:3, :3])
        assert np.array_equal(back, start)


def test_stops_listening_when_stopped() -> None:
    station = Station()
    with station.preview as preview:
        viewer = preview.connect(ignore)
        take(viewer)
    station.publish_state(HOME + 0.1)
    station.preview.update()
    assert take(viewer) == []


def test_the_page_uses_the_same_colours_everywhere() -> None:
    web = Path(__file__).parents[3] / "clients" / "web"
    style = re.findall(r"--way-\d: #([0-9a-f]{6});", (web / "style.css").read_text())
    (drawn,) = re.findall(r"WAY_COLORS = \[(.*?)\]", (web / "way_colors.js").read_text())
    assert drawn.split(", ") == [f"0x{color}" for color in style]
