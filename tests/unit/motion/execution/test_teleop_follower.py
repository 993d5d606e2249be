"""The arm mirrors a hand: within all limits and clear of everything, whatever the hand does."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from teachpath.motion.arm.kinematics import min_singular_value, tool_pose
from teachpath.motion.arm.model import Arm, Payload
from teachpath.motion.arm.tool_speed import difference_speeds
from teachpath.motion.collision.builtin_scenes import empty_scene, paper_scene
from teachpath.motion.collision.collision_model import CollisionModel, grasped_load
from teachpath.motion.execution.teleop_follower import TeleopFollower
from teachpath.motion.settings import MotionSettings
from teachpath.records import Scene, Shape, ToolPose
from tests.unit.motion.collision.test_boundaries import over

ARM = Arm.of_variant()

SETTINGS = MotionSettings()
HOME = np.array(SETTINGS.home)
DT, TARGET_STRIDE = 0.004, 5  # control period, and periods between two samples of the hand
SHARE = 0.5
SLOW_ARM = replace(ARM, tool_speed=0.1)


class Session:
    """A follower, the setpoints that it made, and a hand."""

    def __init__(self, scene: Scene | None = None, begin: np.ndarray = HOME, *, arm: Arm = ARM, **given: float) -> None:
        self.model = CollisionModel(scene or empty_scene(), arm)
        self.follower = TeleopFollower(self.model, begin, SETTINGS, share=SHARE, **given)
        self.sent = [begin]
        self.states = [np.array([begin, *np.zeros((2, 6))])]  # (3, 6) position, velocity and acceleration of setpoints
        self.reasons: set[str] = set()

    def run(self, periods: int, hand: np.ndarray | None = None, turn: np.ndarray | None = None) -> np.ndarray:
        """Hold the hand at a place, turned by a rotation vector, for some periods; return the tool's place."""
        orientation = None if turn is None else Rotation.from_rotvec(turn).as_matrix()
        for k in range(periods):
            if hand is not None and k % TARGET_STRIDE == 0:
                self.follower.set_hand(hand, len(self.sent), orientation)
            self.states.append(np.array(self.follower.step()))
            self.sent.append(self.states[-1][0])
            self.follower.advance_planning()
            self.reasons.add(self.follower.reason)
        return self.tool()

    def turned(self) -> np.ndarray:
        """Return the rotation vectors (n, 3) [rad] of the tool from where it began, at all setpoints."""
        turns = tool_pose(np.array(self.sent), self.model.arm)[:, :3, :3]
        return np.asarray(Rotation.from_matrix(turns @ turns[0].T).as_rotvec())

    def tool(self) -> np.ndarray:
        return np.asarray(tool_pose(self.sent[-1], self.model.arm)[:3, 3])

    def between(self, count: int) -> np.ndarray:
        """Return positions, velocities and accelerations (3, n, 6) at moments between the setpoints, too.

        A player joins two setpoints by the one polynomial that meets both; here that is a cubic.
        """
        p, v, a = np.moveaxis(np.array(self.states), 1, 0)
        t, jerk = DT * np.linspace(0.0, 1.0, count, endpoint=False)[:, None], np.diff(a, axis=0)[:, None] / DT
        p, v, a = (rows[:, None] for rows in (p, v, a))
        np.testing.assert_allclose((p + v * DT + a * DT**2 / 2)[:-1] + jerk * DT**3 / 6, p[1:], rtol=0, atol=1e-12)
        np.testing.assert_allclose((v + a * DT)[:-1] + jerk * DT**2 / 2, v[1:], rtol=0, atol=1e-9)
        p, v, a = p[:-1], v[:-1], a[:-1]
        rows = (p + v * t + a * t**2 / 2 + jerk * t**3 / 6, v + a * t + jerk * t**2 / 2, a + jerk * t)
        return np.array([row.reshape(-1, 6) for row in rows])

    def within_limits(self) -> bool:
        """Tell whether ranges, speeds, accelerations and jerks are kept at every moment."""
        q, speed, acceleration = self.between(8)
        jerk = np.diff(np.array(self.states)[:, 2], axis=0) / DT
        limits = ARM.limits
        uses = zip((speed, acceleration, jerk), (limits.speed, limits.acceleration, limits.jerk), strict=True)
        return bool(np.all(q >= limits.lower - 1e-9) and np.all(q <= limits.upper + 1e-9)) and all(
            bool(np.all(np.abs(rows) <= SHARE * limit * (1 + 1e-6))) for rows, limit in uses
        )


@pytest.mark.parametrize("scale", [1.0, 0.3])
def test_the_tool_goes_where_the_hand_went_scaled_and_keeps_its_orientation(scale: float) -> None:
    session = Session(scale=scale)
    begin, hand = session.tool(), np.array([3.0, 1.0, -2.0])
    session.follower.engage(hand)
    way = np.array([0.05, 0.08, 0.04])
    end = session.run(600, hand + way)
    np.testing.assert_allclose(end - begin, scale * way, atol=1e-6)
    np.testing.assert_allclose(tool_pose(session.sent[-1], ARM)[:3, :3], tool_pose(HOME, ARM)[:3, :3], atol=1e-6)
    assert session.follower.at_rest
    assert session.within_limits()
    assert session.reasons == {""}


def test_a_tool_off_the_axis_of_joint_6_keeps_its_orientation_on_the_way_too() -> None:
    tool = ToolPose((0.05, -0.04, 0.16), (np.cos(0.2), 0.6 * np.sin(0.2), 0.8 * np.sin(0.2), 0.0))
    session = Session(arm=replace(ARM, tool=tool))
    begin, way = session.tool(), np.array([0.05, 0.08, 0.04])
    session.follower.engage(np.zeros(3))
    np.testing.assert_allclose(session.run(600, way) - begin, way, atol=1e-6)
    assert np.linalg.norm(session.turned(), axis=1).max() < np.radians(1.0)
    assert session.within_limits()
    assert session.reasons == {""}


def test_a_clutch_that_is_pressed_again_elsewhere_makes_no_jump() -> None:
    session = Session()
    session.follower.engage(np.zeros(3))
    there = session.run(400, np.array([0.0, 0.06, 0.0]))
    session.follower.disengage()
    session.run(100)
    session.follower.engage(np.array([9.0, 9.0, 9.0]))
    np.testing.assert_allclose(session.run(300, np.array([9.0, 9.0, 9.0])), there, atol=1e-6)
    np.testing.assert_allclose(session.run(400, np.array([9.0, 9.0, 9.05])), there + np.array([0, 0, 0.05]), atol=1e-6)
    assert session.within_limits()


def test_a_released_clutch_stops_the_arm_soon() -> None:
    session = Session()
    session.follower.engage(np.zeros(3))
    session.run(60, np.array([0.0, 0.3, 0.0]))
    assert not session.follower.at_rest
    session.follower.disengage()
    session.run(125)  # half a second
    assert session.follower.at_rest
    assert session.within_limits()


def test_a_wild_hand_leaves_the_arm_within_its_limits_and_clear() -> None:
    rng = np.random.default_rng(5)
    session = Session(paper_scene())
    session.follower.engage(np.zeros(3))
    for _ in range(60):
        hand = rng.normal(0.0, 0.25, 3) if rng.random() < 0.3 else rng.normal(0.0, 5.0, 3)
        session.run(int(rng.integers(3, 40)), hand)
    session.run(300)
    assert session.within_limits()
    assert np.degrees(np.linalg.norm(session.turned(), axis=1)).max() < 1.0
    rows = session.model.clearances(np.array(session.sent[::4]))
    assert min(row.distance for row in rows) >= SETTINGS.clearance_min
    assert len(session.reasons) > 2


@pytest.mark.parametrize(
    ("way", "words"),
    [
        ([2.0, 0.0, 0.0], "reach|stretched|limit"),
        ([0.0, 0.0, -0.6], "would come within"),
        ([0, 0, 3.0], "reach|stretched|limit"),
    ],
)
def test_what_cannot_be_reached_is_said_and_the_arm_stays_as_near_as_it_safely_may(
    way: list[float], words: str
) -> None:
    session = Session(paper_scene())
    begin = session.tool()
    session.follower.engage(np.zeros(3))
    session.run(900, np.array(way))
    assert any(word in reason for word in words.split("|") for reason in session.reasons)
    gone = (session.tool() - begin) @ np.array(way) / np.linalg.norm(way)
    assert gone > 0.02
    assert session.within_limits()
    assert np.degrees(np.linalg.norm(session.turned(), axis=1)).max() < 1.0
    back = session.run(900, np.zeros(3))
    np.testing.assert_allclose(back, begin, atol=2e-3)
    assert session.follower.reason == ""


def test_what_stood_in_the_way_once_shortens_no_later_move() -> None:
    session = Session(paper_scene())
    session.follower.engage(np.zeros(3))
    session.run(600, np.array([0.0, 0.0, -0.6]))  # pressed against something until next to nothing is tried
    session.follower.disengage()
    session.run(125)
    begin, small = session.tool(), np.array([0.0, 0.0, 0.002])
    session.follower.engage(np.zeros(3))
    np.testing.assert_allclose(session.run(150, small) - begin, small, atol=1e-6)
    assert session.follower.reason == ""


def test_a_tool_that_is_slow_since_its_steps_are_checked_says_so_while_it_is() -> None:
    tall = Shape("block", "box", (0.06, 0.06, 0.1), (0.5, 0.1, 0.05))
    session = Session(Scene("s", carried=tall), over(*tall.position)[0])
    session.follower.load = grasped_load(session.model, session.sent[-1])
    session.follower.engage(np.zeros(3))
    session.run(300, np.array([0.1, 0.1, 0.0]))  # along the floor, on which it stood
    assert any("near to what it stood on, so every step is checked first" in reason for reason in session.reasons)
    session.run(600, np.array([0.0, 0.0, 0.1]))
    assert session.follower.reason == ""


ROOMY = np.array([0.365, 1.3, -2.9, 0.0, -1.2, 0.365])  # far from the limits of the joints, the tool tilted ahead


@pytest.mark.parametrize("seed", range(2))
def test_the_tool_keeps_its_orientation_on_the_way_of_a_random_hand(seed: int) -> None:
    rng = np.random.default_rng(seed)
    session = Session()
    session.follower.engage(np.zeros(3))
    for _ in range(30):  # a new place every 40 to 200 ms: the arm is always on its way
        session.run(int(rng.integers(10, 50)), rng.uniform([-0.1, -0.15, -0.02], [0.05, 0.15, 0.1]))
    assert np.degrees(np.linalg.norm(session.turned(), axis=1)).max() < 1.0
    assert session.within_limits()


@pytest.mark.parametrize("turn", [(0.3, 0.0, 0.0), (0.0, 0.2, 0.0), (0.0, 0.0, -0.6), (0.15, 0.2, 0.3)])
def test_the_tool_turns_as_the_hand_turned_since_the_clutch(turn: tuple[float, float, float]) -> None:
    session = Session(begin=ROOMY)
    began, way = Rotation.from_rotvec([2.0, -1.0, 0.5]), np.array([0.02, 0.03, 0.05])
    place = session.tool()
    session.follower.engage(np.zeros(3), began.as_matrix())
    session.run(600, way, (Rotation.from_rotvec(turn) * began).as_rotvec())
    np.testing.assert_allclose(session.turned()[-1], turn, atol=1e-6)
    np.testing.assert_allclose(session.tool() - place, way, atol=1e-6)
    assert session.within_limits()
    assert session.reasons == {""}


def test_a_turn_that_the_joints_do_not_have_gives_way_and_the_place_is_kept() -> None:
    session = Session(begin=ROOMY)
    place, way = session.tool(), np.array([0.0, 0.05, 0.02])
    session.follower.engage(np.zeros(3), np.eye(3))
    session.run(900, way, np.array([0.0, 1.5, 0.0]))
    np.testing.assert_allclose(session.tool() - place, way, atol=1e-3)
    assert 0.1 < np.linalg.norm(session.turned()[-1]) < 1.4
    assert any("joint 5 is at its limit" in reason and "turns less" in reason for reason in session.reasons)
    assert session.within_limits()
    session.run(900, way, np.zeros(3))
    np.testing.assert_allclose(session.turned()[-1], 0.0, atol=1e-6)
    assert session.follower.reason == ""


@pytest.mark.parametrize("seed", range(2))
def test_a_hand_that_turns_wildly_exceeds_no_limit_passes_no_singular_pose_and_is_told_why(seed: int) -> None:
    rng = np.random.default_rng(seed)
    session = Session(paper_scene())
    session.follower.engage(np.zeros(3), np.eye(3))
    for _ in range(30):
        session.run(int(rng.integers(3, 60)), rng.normal(0.0, 0.3, 3), rng.normal(0.0, 1.0, 3))
    session.follower.disengage()
    session.run(125)  # half a second
    sent = np.array(session.sent)
    assert session.within_limits()
    assert session.follower.at_rest
    assert min(row.distance for row in session.model.clearances(sent[::4])) >= SETTINGS.clearance_min
    assert min_singular_value(sent, ARM).min() > 0.5 * SETTINGS.least_singular
    assert any("turns less" in reason for reason in session.reasons)
    assert any("stays short" in reason for reason in session.reasons)


def test_setpoints_say_how_fast_they_move() -> None:
    session = Session(begin=ROOMY)
    session.follower.engage(np.zeros(3), np.eye(3))
    session.run(40, np.array([0.03, 0.05, 0.05]), np.array([0.2, 0.1, -0.3]))
    motion = []
    for _ in range(100):
        motion.append(session.follower.step())
        session.follower.advance_planning()
    positions, speeds, accelerations = (np.array(rows) for rows in zip(*motion, strict=True))
    jerk = ARM.limits.jerk
    assert np.abs(np.gradient(positions, DT, axis=0) - speeds)[1:-1].max(axis=0) == pytest.approx(
        0, abs=jerk.max() * DT**2
    )
    assert np.abs(np.gradient(speeds, DT, axis=0) - accelerations)[1:-1].max() < jerk.max() * DT


def test_an_arm_whose_payload_is_too_heavy_stays_where_it_is_and_says_so() -> None:
    session = Session(arm=replace(ARM, payload=Payload(10.0, (0.3, 0.0, 0.5))))
    session.follower.engage(np.zeros(3))
    session.run(100, np.array([0.05, 0.0, 0.0]))
    np.testing.assert_array_equal(session.sent[-1], HOME)
    assert any("is too weak there for the arm and what it carries" in reason for reason in session.reasons)


def test_a_limit_of_the_tools_speed_holds_however_the_hand_moves_and_the_tool_still_arrives() -> None:
    session = Session(arm=SLOW_ARM)
    begin, hand = session.tool(), np.zeros(3)
    session.follower.engage(hand)
    rng = np.random.default_rng(5)
    for _ in range(25):
        session.run(int(rng.integers(5, 60)), hand + rng.uniform(-0.12, 0.12, 3))
    way = np.array([0.04, 0.05, 0.03])
    np.testing.assert_allclose(session.run(1200, hand + way) - begin, way, atol=1e-6)
    speeds = difference_speeds(session.between(4)[0], 4 / DT, SLOW_ARM)
    assert 0.09 < speeds.max() <= 0.1 * (1 + 1e-6)
    assert session.within_limits()
