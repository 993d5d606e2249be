"""The arm mirrors a live hand: the clutch, a lost hand, and who may."""

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from teachpath.errors import Conflict, NotFound, PathRefused, UnusableInput
from teachpath.io.documents import encode
from teachpath.io.wire import encode_sample
from teachpath.motion.arm.kinematics import tool_pose
from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.collision_model import CollisionModel
from teachpath.motion.settings import MotionSettings
from teachpath.records import Calibration, TeleopRequest
from tests.unit.executor.executors import HOME, KEYS, PERIOD_NS, Bench, standing, within_limits
from tests.unit.recording.hands import sample

ARM = Arm.of_variant()

CLUTCH = 4
ORDER = TeleopRequest("glove", Calibration("identity"), "empty")


class Held(Bench):
    """A bench with a hand that is shown 50 times a second."""

    def __init__(self, hand_scene: str = "") -> None:
        super().__init__(hand_scene=hand_scene)
        self.hand, self.buttons, self.shown, self.number = np.zeros(3), 0, True, 0
        self.turn: Rotation | None = Rotation.identity()  # of the hand; None: it is not measured
        self.session = "this process"  # that sends the hand's samples
        self.intruder: np.ndarray | None = None  # hand of another session, that presses the clutch too
        self.page: int | None = None  # buttons of a page that looks on; None: there is none

    def sleep(self, duration: float) -> None:
        if self.now // PERIOD_NS % 5 == 0:
            self.number += 1
            if self.shown:
                self.show("glove", self.hand, self.buttons)
            if self.intruder is not None:
                self.show("glove", self.intruder, CLUTCH, "theirs")
            if self.page is not None:
                self.show("page", np.ones(3), self.page)
        super().sleep(duration)

    def show(self, tracker: str, hand: np.ndarray, buttons: int, source: str = "") -> None:
        turn = None if self.turn is None else tuple(self.turn.as_quat(scalar_first=True).tolist())
        shown = sample(self.number, tuple(hand), buttons=buttons, orientation=turn)
        self.bus.publish(KEYS.samples(tracker), encode_sample(shown), source=source or self.session)

    def press(self) -> None:
        self.buttons = CLUTCH

    def teleoperate(self, order: TeleopRequest = ORDER) -> None:
        self.when(lambda: self.now > PERIOD_NS, lambda: self.command("teleoperate", teleop=encode(order)))
        self.when(lambda: "press the clutch" in self.statuses[-1].reason, lambda: None)
        self.after(0.1)
        self.when(lambda: True, self.press)

    def after(self, seconds: float) -> None:
        """Let time pass."""
        until: list[int] = []
        self.when(lambda: True, lambda: until.append(self.now + round(seconds * 1e9)))
        self.when(lambda: self.now > until[0], lambda: None)


@pytest.mark.parametrize(("orientation", "turned", "hint"), [("keep", 0.0, ""), ("follow", 0.2, "not measured")])
def test_the_tool_keeps_its_orientation_or_follows_the_hands_own(orientation: str, turned: float, hint: str) -> None:
    bench, says = Held(), set[str]()
    turn = Rotation.from_rotvec([0.0, 0.0, 0.2])
    calibration = Calibration("turned", rotation=(0.5**0.5, 0.5**0.5, 0.0, 0.0))  # z of the tracker is -y of the world
    bench.teleoperate(replace(ORDER, calibration=calibration, orientation=orientation))
    bench.when(lambda: bench.state == "following", lambda: setattr(bench, "turn", turn))
    bench.after(2.0)
    bench.when(lambda: True, lambda: setattr(bench, "turn", None))
    bench.after(0.2)
    bench.when(lambda: True, lambda: says.add(bench.statuses[-1].activity))
    bench.when(lambda: True, lambda: bench.command("stop"))
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    poses = [tool_pose(q, ARM)[:3, :3] for q in (bench.setpoints[-1].position, HOME)]
    found = Rotation.from_matrix(poses[0] @ poses[1].T).as_rotvec()
    np.testing.assert_allclose(found, [0.0, -turned, 0.0], atol=1e-6)
    assert hint in says.pop()
    assert within_limits(bench.setpoints)


@pytest.mark.parametrize("session", ["mine", ""])
def test_a_hand_of_another_session_under_the_same_name_leads_nothing_and_is_reported(session: str) -> None:
    bench, seen, says = Held(), [], set[str]()
    bench.session = "mine"
    bench.teleoperate(replace(ORDER, tracker_session=session))
    bench.when(lambda: bench.state == "following", lambda: setattr(bench, "intruder", np.array([0.1, 0.1, 0.1])))
    bench.after(1.0)
    bench.when(lambda: True, lambda: seen.append(moved(bench)))
    bench.when(lambda: True, lambda: says.add(bench.statuses[-1].activity))
    bench.when(lambda: True, lambda: setattr(bench, "shown", False))
    bench.when(lambda: bench.state == "held", lambda: says.add(bench.statuses[-1].reason))
    bench.after(0.5)
    bench.when(lambda: True, lambda: seen.append(moved(bench)))
    bench.when(lambda: True, lambda: bench.command("stop"))
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    np.testing.assert_allclose(seen, np.zeros((2, 3)), atol=1e-6)
    assert any("another session sends as glove too" in sentence for sentence in says)
    assert any("glove was lost, and another session sends" in sentence for sentence in says)


def test_a_hand_that_names_no_session_moves_nothing_and_is_told_why() -> None:
    bench, says = Held(), list[str]()
    bench.when(lambda: bool(bench.statuses), lambda: bench.command("teleoperate", teleop=encode(ORDER)))
    bench.session = ""
    bench.when(lambda: bench.state == "held", lambda: None)
    bench.after(0.3)
    bench.when(lambda: True, bench.press)
    bench.after(1.0)
    bench.when(lambda: True, lambda: says.append(bench.statuses[-1].activity))
    bench.when(lambda: True, lambda: bench.command("stop"))
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    assert "samples as glove name no session" in says[0]
    assert "following" not in bench.states()
    np.testing.assert_allclose(moved(bench), np.zeros(3), atol=1e-9)


@pytest.mark.parametrize(
    ("field", "value", "sentence"),
    [
        ("offset", "[NaN, 0.0, 0.0]", "NaN is no finite number"),
        ("offset", "[0.0, 1e999, 0.0]", "1e999 is no finite number"),
        ("rotation", "[0.0, 0.0, 0.0, 0.0]", "no value of calibration.rotation"),
        ("rotation", "[9.0, 0.0, 0.0, 0.0]", "no value of calibration.rotation"),
        ("scale", "-1.0", "calibration.scale -1"),
        ("scale", "1e300", "calibration.scale 1e\\+300"),
    ],
)
def test_an_order_with_a_calibration_that_is_none_moves_nothing(field: str, value: str, sentence: str) -> None:
    bench, order = Held(), json.loads(encode(ORDER))
    order["calibration"][field] = "PLACE"
    payload = json.dumps(order).replace('"PLACE"', value).encode()

    def refuse() -> None:
        with pytest.raises(UnusableInput, match=sentence):
            bench.command("teleoperate", teleop=payload)

    bench.when(lambda: bool(bench.statuses), refuse)
    bench.when(lambda: True, bench.stop.set)
    bench.run()
    assert bench.setpoints == []


def test_an_order_brings_no_scene_of_its_own_and_without_the_stations_nothing_moves() -> None:
    bench = Held()
    forged = json.loads(encode(ORDER)) | {"scene": json.loads(encode(bench.scenes["empty"]))}
    bench.scenes = {"paper": bench.scenes["paper"]}

    def refuse() -> None:
        for order in (json.dumps(forged).encode(), encode(ORDER)):
            with pytest.raises(NotFound, match="no scene"):
                bench.command("teleoperate", teleop=order)

    bench.when(lambda: bool(bench.statuses), refuse)
    bench.when(lambda: True, bench.stop.set)
    bench.run()
    assert bench.setpoints == []


def test_where_one_scene_is_set_for_live_hands_no_order_names_another() -> None:
    bench, says = Held("empty"), set[str]()

    def refuse() -> None:
        with pytest.raises(PathRefused, match=r"in scene empty alone .* not in paper"):
            bench.command("teleoperate", teleop=encode(replace(ORDER, scene="paper")))

    bench.when(lambda: bool(bench.statuses), refuse)
    bench.teleoperate()
    bench.when(lambda: bench.state == "following", lambda: says.add(bench.statuses[-1].activity))
    bench.when(lambda: True, lambda: bench.command("stop"))
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    assert "in scene empty" in says.pop()


def test_the_live_hand_keeps_clear_of_what_the_station_has_in_the_scene() -> None:
    bench = Held()
    bench.scenes = {"empty": replace(bench.scenes["paper"], name="empty")}  # what was empty when it was ordered last
    bench.teleoperate()
    bench.when(lambda: bench.state == "following", lambda: setattr(bench, "hand", np.array([0.0, 0.0, -0.6])))
    bench.after(2.0)
    bench.when(lambda: True, lambda: bench.command("stop"))
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    sent = np.array([setpoint.position for setpoint in bench.setpoints])
    rows = CollisionModel(bench.scenes["empty"], ARM).clearances(sent[::4])
    assert min(row.distance for row in rows) >= MotionSettings().clearance_min


def moved(bench: Held) -> np.ndarray:
    return tool_pose(bench.setpoints[-1].position, ARM)[:3, 3] - tool_pose(HOME, ARM)[:3, 3]


def test_the_arm_follows_while_the_clutch_is_pressed_and_a_lost_hand_needs_it_again() -> None:
    bench, seen = Held(), []
    bench.teleoperate()
    bench.when(lambda: bench.state == "following", lambda: setattr(bench, "hand", np.array([0.0, 0.05, 0.03])))
    bench.after(2.0)
    bench.when(lambda: True, lambda: seen.append(moved(bench)))
    bench.when(lambda: True, lambda: setattr(bench, "shown", False))
    bench.when(lambda: "the hand was lost" in bench.statuses[-1].reason, lambda: setattr(bench, "hand", np.ones(3)))
    bench.when(lambda: True, lambda: setattr(bench, "shown", True))
    bench.after(0.5)
    bench.when(lambda: True, lambda: seen.append(moved(bench)))
    bench.when(lambda: True, lambda: bench.command("stop"))
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    np.testing.assert_allclose(seen, [[0.0, 0.05, 0.03]] * 2, atol=1e-5)
    assert bench.states() == ["idle", "held", "following", "held", "ended"]
    assert standing(bench.setpoints)
    assert within_limits(bench.setpoints)
    assert 0 < bench.statuses[-1].hand_latency_p50_us <= bench.statuses[-1].hand_latency_p99_us <= 40_000


def test_what_does_not_fit_a_live_hand_is_refused() -> None:
    bench, seen = Held(), []

    def refuse() -> None:
        for verb, kind, given in (
            ("step", Conflict, {"length": 0.1}),
            ("start", Conflict, {"plan": b"{}"}),
            ("teleoperate", Conflict, {"teleop": encode(ORDER)}),
        ):
            with pytest.raises(kind):
                bench.command(verb, **given)
        seen.append("refused")

    def too_large() -> None:
        with pytest.raises(UnusableInput, match="scale 90"):
            bench.command("teleoperate", teleop=encode(replace(ORDER, scale=90.0)))

    bench.when(lambda: bench.now > PERIOD_NS, too_large)
    bench.teleoperate()
    bench.when(lambda: bench.state == "following", refuse)
    bench.when(lambda: True, lambda: bench.command("hold"))
    bench.when(lambda: bench.state == "held", lambda: bench.command("stop"))
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    assert seen == ["refused"]


@pytest.mark.parametrize(("left", "why"), [(0, "press the clutch"), (None, "nothing was heard of page")])
def test_a_page_that_looks_on_presses_the_clutch_and_letting_go_or_leaving_holds_the_arm(
    left: int | None, why: str
) -> None:
    bench, seen = Held(), []
    bench.page = 0
    bench.teleoperate(replace(ORDER, clutch="page"))
    bench.after(0.3)
    bench.when(lambda: True, lambda: seen.append(moved(bench)))  # the hand's own button is no clutch now
    bench.when(lambda: bench.state == "held", lambda: setattr(bench, "page", CLUTCH))
    bench.when(lambda: bench.state == "following", lambda: setattr(bench, "hand", np.array([0.0, 0.05, 0.03])))
    bench.after(2.0)
    bench.when(lambda: True, lambda: setattr(bench, "page", left))
    bench.when(lambda: why in bench.statuses[-1].reason, lambda: setattr(bench, "hand", np.ones(3)))
    bench.after(0.5)
    bench.when(lambda: True, lambda: seen.append(moved(bench)))
    bench.when(lambda: True, lambda: bench.command("stop"))
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    np.testing.assert_allclose(seen, [np.zeros(3), [0.0, 0.05, 0.03]], atol=1e-5)
    assert standing(bench.setpoints)
    assert within_limits(bench.setpoints)


def led_to(place: list[float]) -> tuple[Held, list[np.ndarray]]:
    """Return a bench whose hand leads the arm to a place and is lost there, and what `moved` was then."""
    bench, seen = Held(), []
    bench.teleoperate()
    bench.when(lambda: bench.state == "following", lambda: setattr(bench, "hand", np.array(place)))
    bench.after(2.0)
    bench.when(lambda: True, lambda: seen.append(moved(bench)))
    return bench, seen


def ended(bench: Held, seen: list[np.ndarray]) -> None:
    """Let the bench run on for a while, then stop it."""
    bench.after(2.0)
    bench.when(lambda: True, lambda: seen.append(moved(bench)))
    bench.when(lambda: True, lambda: bench.command("stop"))
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    assert within_limits(bench.setpoints)


@pytest.mark.parametrize(
    ("away", "place", "buttons", "words"),
    [
        (0.5, [0.0, 0.07, 0.05], CLUTCH, ""),
        (0.5, [0.0, 0.2, 0.05], CLUTCH, "the hand moved too far"),
        (0.5, [0.0, 0.07, 0.05], 0, "press the clutch"),
        (2.0, [0.0, 0.05, 0.03], CLUTCH, "let the clutch go"),
    ],
)
def test_a_hand_that_is_lost_for_a_moment_is_followed_on_and_any_other_needs_its_clutch_again(
    away: float, place: list[float], buttons: int, words: str
) -> None:
    bench, seen = led_to([0.0, 0.05, 0.03])
    bench.when(lambda: True, lambda: setattr(bench, "shown", False))
    bench.when(lambda: "goes on by itself" in bench.statuses[-1].reason, lambda: None)
    bench.after(away)
    bench.when(lambda: True, lambda: setattr(bench, "hand", np.array(place)))
    bench.when(lambda: True, lambda: setattr(bench, "buttons", buttons))
    bench.when(lambda: True, lambda: setattr(bench, "shown", True))
    says: list[str] = []
    bench.after(1.0)
    bench.when(lambda: True, lambda: says.append(bench.statuses[-1].reason))
    ended(bench, seen)
    assert words in says[0]
    assert bench.states() == ["idle", "held", "following", "held", *["following"] * (words == ""), "ended"]
    np.testing.assert_allclose(seen, [[0.0, 0.05, 0.03], [0.0, 0.05, 0.03] if words else place], atol=1e-5)


def test_a_page_that_presses_the_clutch_and_is_gone_for_a_moment_goes_on_leading() -> None:
    bench, seen = Held(), []
    bench.page = 0
    bench.teleoperate(replace(ORDER, clutch="page"))
    bench.when(lambda: bench.state == "held", lambda: setattr(bench, "page", CLUTCH))
    bench.when(lambda: bench.state == "following", lambda: setattr(bench, "page", None))
    bench.when(lambda: "nothing was heard of page" in bench.statuses[-1].reason, lambda: None)
    bench.when(lambda: True, lambda: setattr(bench, "hand", np.array([0.0, 0.05, 0.03])))
    bench.after(0.5)
    bench.when(lambda: True, lambda: seen.append(moved(bench)))  # it waits for the page, whatever the hand does
    bench.when(lambda: True, lambda: setattr(bench, "page", CLUTCH))
    ended(bench, seen)
    np.testing.assert_allclose(seen, [np.zeros(3), [0.0, 0.05, 0.03]], atol=1e-5)


def test_an_arm_that_was_late_goes_on_behind_its_hand() -> None:
    bench, seen = Held(), []
    bench.teleoperate()
    bench.when(lambda: bench.state == "following", lambda: setattr(bench, "hand", np.array([0.0, 0.07, 0.03])))
    bench.after(0.1)
    bench.when(lambda: True, lambda: setattr(bench, "pace", 0.02))
    bench.when(lambda: "the arm is late" in bench.statuses[-1].reason, lambda: setattr(bench, "pace", 3.0))
    ended(bench, seen)
    assert "following" in bench.states()[bench.states().index("following") + 1 :]
    np.testing.assert_allclose(seen[-1], [0.0, 0.07, 0.03], atol=1e-5)
