"""A simulated arm whose clock and bus are the test's own."""

import threading
from collections.abc import Callable

import numpy as np

from teachpath.io import wire
from teachpath.io.memory_bus import MemoryBus
from teachpath.motion.arm.kinematics import downward_poses, inverse_kinematics
from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.builtin_scenes import empty_scene
from teachpath.motion.settings import MotionSettings
from teachpath.records import JointState, Scene, Setpoint
from teachpath.simulator.loop import Simulator
from teachpath.simulator.settings import SimulatorSettings
from teachpath.time_source import TimeSource
from teachpath_proto.keys import Keys

ARM = Arm.of_variant()


KEYS = Keys()


SETTINGS = SimulatorSettings(realtime=False)


HOME = np.array(MotionSettings().home)


START = 1_700_000_000_000_000_000


PERIOD_NS = 4_000_000


NO_WAY_TO_REST = np.empty((0, 3, 6))


class Bench:
    """A simulator in its own time, a sender of setpoints and all joint states that were published."""

    def __init__(self, scene: Scene | None = None) -> None:
        self.bus = MemoryBus()
        self.states: list[JointState] = []
        self.now = START
        self.stop = threading.Event()
        self.simulator = Simulator(
            self.bus,
            KEYS,
            scene or empty_scene(),
            SETTINGS,
            time_source=TimeSource(wall_ns=lambda: self.now, sleep=self._sleep, wait=self._doze),
        )
        self.steps = 0  # of 1 ms that were computed
        self.bus.subscribe(KEYS.state("puma560"), lambda _, p: self.states.append(wire.decode_state(p)))
        self.until = START
        self.each: Callable[[int], None] = lambda now: None
        self.cycle = 0
        self.wanted = HOME

    def _sleep(self, seconds: float) -> None:
        self.steps += 1
        self._pass(round(seconds * 1e9))

    def _doze(self, woken: threading.Event, seconds: float) -> None:
        end = self.now + round(seconds * 1e9)
        while self.now < end and not woken.is_set() and not self.stop.is_set():
            self._pass(1_000_000)

    def _pass(self, duration: int) -> None:
        self.now += duration
        self.each(self.now)
        if self.now >= self.until:
            self.stop.set()

    def run(self, seconds: float, each: Callable[[int], None] = lambda now: None) -> list[JointState]:
        """Let it run for a while, calling `each(now)` every millisecond; returns the joint states of that while."""
        before = len(self.states)
        self.until, self.each = self.now + round(seconds * 1e9), each
        self.stop.clear()
        self.simulator.run(self.stop)
        return self.states[before:]

    def send(
        self,
        q: np.ndarray,
        v: np.ndarray,
        a: np.ndarray,
        *,
        closed: bool = False,
        execution: str = "e1",
        way: np.ndarray = NO_WAY_TO_REST,
    ) -> None:
        self.cycle += 1
        setpoint = Setpoint(self.cycle, self.now, self.now, q, v, a, closed, execution, way_to_rest=way)
        self.bus.publish(KEYS.setpoint("puma560"), wire.encode_setpoint(setpoint))

    def move(self, goal: np.ndarray, seconds: float, *, closed: bool = False, skip: int = 0) -> list[JointState]:
        """Stream a quintic move to `goal` at 250 Hz; every `skip`-th setpoint gets lost."""
        begin, origin = self.wanted, self.now

        def each(now: int) -> None:
            if now - origin == 1_000_000:  # every stream begins at rest
                self.send(begin, np.zeros(6), np.zeros(6), closed=closed)
            if (now - origin) % PERIOD_NS:
                return
            t = min((now - origin) / 1e9 / seconds, 1.0)
            s, ds = 10 * t**3 - 15 * t**4 + 6 * t**5, (30 * t**2 - 60 * t**3 + 30 * t**4) / seconds
            dds = (60 * t - 180 * t**2 + 120 * t**3) / seconds**2
            if skip and (self.cycle + 1) % skip == 0:
                self.cycle += 1
            else:
                self.send(begin + s * (goal - begin), ds * (goal - begin), dds * (goal - begin), closed=closed)

        states = self.run(seconds, each)
        self.wanted = goal
        return states


def above(position: tuple[float, float, float]) -> np.ndarray:
    """A configuration within the limits, of the branch of the home position, with the tool straight down."""
    q = inverse_kinematics(downward_poses(np.array([position]), np.pi), ARM).joints[0, 1]
    for turn in (-2 * np.pi, 2 * np.pi):
        q = np.where((q < ARM.limits.lower) & (turn > 0) | (q > ARM.limits.upper) & (turn < 0), q + turn, q)
    assert np.all((q >= ARM.limits.lower) & (q <= ARM.limits.upper))
    return q
