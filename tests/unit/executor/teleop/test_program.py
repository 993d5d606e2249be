"""The arm follows a live hand: whose, in which scene, and how the tool turns."""

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from teachpath.errors import Conflict, NotFound, PathRefused, UnusableInput
from teachpath.io.documents import encode
from teachpath.motion.arm.kinematics import tool_pose
from teachpath.motion.collision.collision_model import CollisionModel
from teachpath.motion.settings import MotionSettings
from teachpath.records import Calibration
from tests.unit.executor.executors import HOME, PERIOD_NS, within_limits
from tests.unit.executor.teleop.hand_bench import ARM, ORDER, Held, moved


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
    bench.when(lambda: True, lambda: says.add(bench.statuses[-1].hindrance))
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
    bench.when(lambda: True, lambda: says.add(bench.statuses[-1].hindrance))
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
