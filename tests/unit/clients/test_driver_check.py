"""The check of drivers, in a time of its own: one that plays by the player passes, others fail where they are wrong."""

from collections.abc import Callable
from typing import Union

import numpy as np
import pytest

from teachpath.io.memory_bus import MemoryBus
from teachpath.motion.collision.builtin_scenes import empty_scene
from teachpath.simulator.loop import Simulator
from teachpath.simulator.settings import SimulatorSettings
from teachpath_client.driver import PlayerState, SetpointPlayer, decode_setpoint, joint_state
from teachpath_client.driver.check import DriverCheck
from teachpath_client.driver.check_motion import COUNT, PERIOD, Move
from teachpath_client.verdict import Verdict
from teachpath_proto.keys import Keys
from teachpath_proto.motion_pb2 import JointState, Setpoint

Driver = Union["PlayerDriver", "SimulatedDriver", "NaiveDriver"]
HOME = np.array([0.365, 1.663, -3.177, 0.0, -1.628, 0.365])  # [rad]
NOW_NS = 1_700_000_000 * 10**9
STEP_NS = 1_000_000
RULES = 11
KEYS = Keys()


class PlayerDriver:
    """As example 04: an arm that is where the player wants it."""

    def __init__(self) -> None:
        self.player = SetpointPlayer(HOME)

    def receive(self, payload: bytes, now: int) -> None:
        try:
            setpoint = decode_setpoint(payload)
        except ValueError:
            return
        self.player.add(setpoint, now)

    def step(self, now: int) -> None:
        self.player.advance(STEP_NS / 1e9, now)

    def state(self) -> JointState:
        target = self.player.target
        return JointState.FromString(joint_state(self.player, target.position.tolist(), target.velocity.tolist()))


class SimulatedDriver:
    """The simulated arm of a station, on a bus within this process."""

    def __init__(self) -> None:
        bus, self.newest = MemoryBus(), JointState()
        self.simulator = Simulator(bus, KEYS, empty_scene(), SimulatorSettings(realtime=False), home=HOME.tolist())
        bus.subscribe(KEYS.state("puma560"), lambda _, payload: self.newest.ParseFromString(payload))

    def receive(self, payload: bytes, _: int) -> None:
        self.simulator.receive(payload)

    def step(self, now: int) -> None:
        self.simulator.step(now)

    def state(self) -> JointState:
        return JointState.FromString(self.newest.SerializeToString())


class NaiveDriver:
    """Goes where the newest setpoint is, as soon as it comes."""

    def __init__(self) -> None:
        self.newest = Setpoint(position=HOME, velocity=[0.0] * 6)

    def receive(self, payload: bytes, _: int) -> None:
        try:
            self.newest = Setpoint.FromString(payload)
        except Exception:  # whatever the parser raises
            return

    def step(self, _: int) -> None:
        pass

    def state(self) -> JointState:
        m = self.newest
        return JointState(
            position=m.position, velocity=m.velocity, torque=[0.0] * 6, cycle=m.cycle, execution=m.execution,
            enabled=True, gripper_closed=m.gripper_closed,
        )  # fmt: skip


class Finished(PlayerDriver):
    """Takes a rest on the way for the end of the execution."""

    def receive(self, payload: bytes, now: int) -> None:
        last = self.player.last_reached
        over = last is not None and self.player.at_rest and last.position[0] != HOME[0]
        if not (over and last is not None and Setpoint.FromString(payload).execution == last.execution):
            super().receive(payload, now)


class Loyal(PlayerDriver):
    """Waits after a rest on the way for the same execution to go on, as if no executor ever died."""

    def receive(self, payload: bytes, now: int) -> None:
        last, is_stopped = self.player.last_reached, self.player.state is PlayerState.STOPPED
        if not is_stopped or last is None or Setpoint.FromString(payload).execution == last.execution:
            super().receive(payload, now)


class Deaf(PlayerDriver):
    """Speaks, and hears nothing."""

    def receive(self, payload: bytes, now: int) -> None:
        pass


class Silent(PlayerDriver):
    """Says too rarely where the arm is."""

    def state(self) -> JointState:
        raise StopIteration


class Faulty(PlayerDriver):
    """Says that something is wrong with the arm."""

    def state(self) -> JointState:
        state = super().state()
        state.fault = "joint 2 is hot"
        return state


class Reticent(PlayerDriver):
    """Comes to rest as it should, and does not say so."""

    def state(self) -> JointState:
        state = super().state()
        state.holding = state.stopped = False
        return state


class Clumsy(PlayerDriver):
    """Never moves its gripper."""

    def state(self) -> JointState:
        state = super().state()
        state.gripper_closed = False
        return state


class Measuring(PlayerDriver):
    """Measures how far its fingers are apart [m]: closed, and open."""

    openings = (0.0, 0.085)

    def state(self) -> JointState:
        state = super().state()
        state.gripper_opening = self.openings[not state.gripper_closed]
        return state


class Inverted(Measuring):
    """Takes the distance for the closure."""

    openings = (0.085, 0.0)


class InMillimetres(Measuring):
    """Says it in another unit."""

    openings = (0.0, 85.0)


class VirtualBench:
    """Time that is no real time, and a driver in the same process."""

    def __init__(self, driver: Driver) -> None:
        self.states: list[JointState] = []
        self._driver, self._now = driver, NOW_NS

    def now_ns(self) -> int:
        return self._now

    def wait_until(self, time_ns: int) -> None:
        while self._now < time_ns:
            self._now += STEP_NS
            self._driver.step(self._now)
            if self._now % (10 * STEP_NS) == 0:
                try:
                    state = self._driver.state()
                except StopIteration:
                    continue
                state.stamp_ns = self._now
                self.states.append(state)

    def publish(self, payload: bytes) -> None:
        self._driver.receive(payload, self._now)


def verdicts(driver: Driver) -> list[Verdict]:
    return list(DriverCheck(VirtualBench(driver)).run())


def failed(driver: Driver) -> dict[str, str]:
    return {verdict.rule: verdict.fault for verdict in verdicts(driver) if verdict.fault}


@pytest.mark.parametrize("driver", [PlayerDriver, Measuring, SimulatedDriver])
def test_a_driver_that_plays_by_the_player_keeps_every_rule(driver: Callable[[], Driver]) -> None:
    found = verdicts(driver())
    assert len(found) == RULES
    assert [verdict for verdict in found if verdict.fault] == []


def test_a_naive_driver_fails_where_setpoints_come_late_and_where_they_are_wrong() -> None:
    rules = " / ".join(failed(NaiveDriver()))
    for part in ("comes to rest on the way", "burst of overdue", "no setpoint", "begins elsewhere"):
        assert part in rules


@pytest.mark.parametrize(
    ("driver", "rule", "fault"),
    [
        (Silent, "where the arm is", "0 joint states came in a second"),
        (Faulty, "where the arm is", "fault joint 2 is hot"),
        (Deaf, "follows a move", "from where it should"),
        (Reticent, "comes to rest on the way", "holding False, stopped False"),
        (Finished, "is stopped on the way", "from where it should"),
        (Loyal, "begins anew", "from where it should"),
        (Clumsy, "gripper", "should be closed"),
        (Inverted, "gripper", "closed on nothing it measures 0.085 m between its fingers, open 0 m"),
        (InMillimetres, "gripper", "open 85 m; it should be 0 m where they touch"),
    ],
)
def test_what_a_driver_does_wrong_is_named(driver: Callable[[], PlayerDriver], rule: str, fault: str) -> None:
    verdict = next(each for each in DriverCheck(VirtualBench(driver())).run() if rule in each.rule)
    assert fault in verdict.fault


def test_an_arm_that_is_not_fit_is_not_moved() -> None:
    driver = Faulty()
    assert len(verdicts(driver)) == 1
    np.testing.assert_array_equal(driver.player.target.position, HOME)


def test_the_ways_to_rest_of_the_move_lie_on_its_line_and_end_at_rest() -> None:
    move = Move("e", HOME, HOME + np.array([0.2, -0.2, 0.1, 0.0, 0.2, 0.2]))
    for index in range(COUNT):
        setpoint = decode_setpoint(move.setpoint(index, NOW_NS).SerializeToString())
        rows = np.vstack([setpoint.position, setpoint.way_to_rest[:, 0]])
        off = np.linalg.norm(np.cross(rows[:, :3] - HOME[:3], (move.end - HOME)[:3]), axis=1)
        assert off.max() < 1e-12
        assert np.abs(np.diff(rows, axis=0)).max(initial=0.0) / PERIOD <= move.top_speed.max() * (1 + 1e-9)
        np.testing.assert_allclose(rows[-1], move.rest_of(index), atol=1e-12)
