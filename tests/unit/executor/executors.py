"""An executor on a clock of its own, for the tests."""

import gc
import threading
from collections.abc import Callable
from typing import Any, Literal

import numpy as np

from teachpath.errors import NotFound
from teachpath.executor.loop import Executor
from teachpath.executor.settings import ExecutorSettings
from teachpath.io import wire
from teachpath.io.documents import decode, encode
from teachpath.io.memory_bus import MemoryBus
from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.builtin_scenes import builtin_scenes
from teachpath.motion.planning.signature import SigningKey, sign_plan
from teachpath.motion.settings import MotionSettings
from teachpath.records import (
    Command,
    ExecutorStatus,
    JointState,
    JournalEntry,
    Lease,
    LeaseRequest,
    Plan,
    SceneQuery,
    Setpoint,
)
from teachpath.time_source import TimeSource
from teachpath_proto.control import CommandVerb, LeaseAction
from teachpath_proto.keys import Keys

ARM = Arm.of_variant()

KEYS = Keys()
MOTION = MotionSettings()
HOME = np.array(MotionSettings().home)
PERIOD_NS = 4_000_000
OPENING = 0.08  # [m] between the open fingers of a gripper that measures them
EPOCH = 1_700_000_000 * 10**9
KEY = SigningKey(bytes(range(32)))
STUCK_TIMEOUT = 60.0  # s, after which a test gives up


def signed(plan: Plan, *, key: SigningKey = KEY, issued_ns: int = EPOCH, motion: MotionSettings = MOTION) -> Plan:
    """Return a plan as the station of these tests signs it."""
    return sign_plan(plan, Arm.of_settings(motion), motion, key, issued_ns=issued_ns)


class Bench:
    """An executor on a clock of its own, with an arm that is always exactly where its newest setpoint says.

    Its service finds every certificate good, and answers by `confirm`.
    """

    def __init__(
        self,
        position: np.ndarray = HOME,
        motion: MotionSettings | None = None,
        failed_grasp: Literal["fault", "hold"] = "fault",
        hand_scene: str = "",
        arm: Arm | None = None,
        setpoint_timeout: float = 0.5,
        bus: MemoryBus | None = None,
    ) -> None:
        self.bus = bus or MemoryBus()
        self.now = 0
        self.position = position
        self.error = 0.0
        self.drives: dict[str, Any] = {}  # what the joint state says of them; they are on
        self.closed_opening: float | None = None  # [m] between its fingers when they have closed; None: not measured
        self.pushed = 0.0  # [rad] that somebody keeps all joints off their setpoints
        self.velocity = 0.0
        self.speaking = True
        self.deaf: Setpoint | None = None  # the setpoint after which it takes up no other
        self.behind = 0  # setpoints that it is late with
        self.pace = 1.0  # setpoints that it takes up in a period, but for those of a standstill: they take no time
        self._played = 0.0
        self.oversleep: dict[int, int] = {}  # setpoints sent -> ns too late
        self.setpoints: list[Setpoint] = []
        self.statuses: list[ExecutorStatus] = []
        self.journal: list[JournalEntry] = []
        self.stop = threading.Event()
        self.todo: list[tuple[Callable[[], bool], Callable[[], object]]] = []
        self.bus.subscribe(KEYS.setpoint("puma560"), lambda _, p: self.setpoints.append(wire.decode_setpoint(p)))
        self.bus.subscribe(KEYS.executor_status, lambda _, p: self.statuses.append(wire.decode_status(p)))
        self.bus.subscribe(KEYS.executor_journal, lambda _, p: self.journal.append(wire.decode_entry(p)))
        self.confirm: Callable[[bytes], bytes] = lambda query: query
        self.service = self.bus.serve(KEYS.station_certificate, lambda query: self.confirm(query))
        self.scenes = builtin_scenes()
        self.bus.serve(KEYS.station_scene, self._answer_scene)
        self.executor = Executor(
            self.bus,
            KEYS,
            ExecutorSettings(
                realtime=False, failed_grasp=failed_grasp, hand_scene=hand_scene, setpoint_timeout=setpoint_timeout
            ),
            signing_key=KEY,
            motion=motion,
            arm=arm,
            time_source=TimeSource(lambda: self.now, lambda: EPOCH + self.now, self.sleep, self.doze),
        )

    def _answer_scene(self, payload: bytes) -> bytes:
        name = decode(SceneQuery, payload).name
        if name not in self.scenes:
            raise NotFound(f"there is no scene {name!r}")
        return encode(self.scenes[name])

    def when(self, condition: Callable[[], bool], act: Callable[[], object]) -> None:
        """Do something as soon as a condition holds, one thing behind the other."""
        self.todo.append((condition, act))

    def run(self) -> None:
        """Run until all is done and `stop` is set."""
        gc.freeze()  # the executor collects garbage first: not in the thousands of tests that this process holds
        self.executor.run(self.stop)

    def sleep(self, duration: float) -> None:
        self.now += round(duration * 1e9) + self.oversleep.pop(len(self.setpoints), 0)
        assert self.now < STUCK_TIMEOUT * 1e9, f"stuck before step {self.todo[:1]} in {self.statuses[-1]}"
        if self.setpoints:
            self._play()
            self.position = self.taken().position + self.pushed
        if self.speaking:
            self.bus.publish(KEYS.state("puma560"), wire.encode_state(self.joint_state()))
        if self.todo and self.todo[0][0]():
            self.todo.pop(0)[1]()

    def doze(self, woken: threading.Event, duration: float) -> None:
        """Wait at rest; an arm that looks only now and then finds what came meanwhile at the end."""
        self.sleep(duration)

    def taken(self) -> Setpoint:
        """The newest setpoint that the arm has taken up."""
        if self.pace < 1.0:
            return self.setpoints[int(self._played)]
        return self.deaf or self.setpoints[-1 - min(self.behind, len(self.setpoints) - 1)]

    @property
    def late(self) -> int:
        """How many setpoints of a motion the arm has not taken up yet."""
        waiting = self.setpoints[self.taken().cycle + 1 :] if self.setpoints else []
        return sum(not standing([each]) for each in waiting)

    def _play(self) -> None:
        newest = len(self.setpoints) - 1
        self._played = min(self._played + self.pace, newest)
        while (here := int(self._played)) < newest and all(standing([s]) for s in self.setpoints[here : here + 2]):
            self._played += 1

    def joint_state(self) -> JointState:
        newest = self.taken() if self.setpoints else None
        return JointState(
            stamp_ns=EPOCH + self.now,
            cycle=newest.cycle if newest else 0,
            position=self.position,
            velocity=np.full(len(self.position), self.velocity),
            torque=np.zeros(len(self.position)),
            tracking_error=self.error,
            missed=0,
            holding=False,
            gripper_closed=bool(newest and newest.gripper_closed),
            gripper_opening=self._opening(newest),
            object_position=(0.0, 0.0, 0.0),
            object_orientation=(1.0, 0.0, 0.0, 0.0),
            execution=newest.execution if newest else "",
            **self.drives,
        )

    def _opening(self, newest: Setpoint | None) -> float | None:
        return self.closed_opening if self.closed_opening is None or (newest and newest.gripper_closed) else OPENING

    def command(self, verb: str, execution: str = "run-1", **given: object) -> ExecutorStatus:
        return wire.decode_status(
            self.bus.ask(KEYS.executor_command, wire.encode_command(Command(CommandVerb(verb), execution, **given)))  # type: ignore[arg-type]
        )

    def control(self, action: str, name: str = "", **given: object) -> Lease:
        request = LeaseRequest(LeaseAction(action), name, **given)  # type: ignore[arg-type]
        return wire.decode_lease(self.bus.ask(KEYS.executor_lease, wire.encode_lease_request(request)))

    def start(self, what: Plan, override: float = 1.0) -> None:
        self.when(lambda: self.now > PERIOD_NS, lambda: self.command("start", plan=encode(what), override=override))

    @property
    def state(self) -> str:
        return self.statuses[-1].state if self.statuses else ""

    def states(self) -> list[str]:
        """The states in order, without repetitions."""
        seen = [status.state for status in self.statuses]
        return [s for s, before in zip(seen, ["", *seen], strict=False) if s != before]


def standing(setpoints: list[Setpoint]) -> bool:
    return bool(np.all(setpoints[-1].velocity == 0) and np.all(setpoints[-1].acceleration == 0))


def within_limits(setpoints: list[Setpoint]) -> bool:
    positions = np.array([setpoints[0].position] * 3 + [s.position for s in setpoints])
    return all(
        bool(np.all(np.abs(np.diff(positions, k, axis=0)) * 250.0**k <= limit * (1 + 1e-6)))
        for k, limit in ((1, ARM.limits.speed), (2, ARM.limits.acceleration), (3, ARM.limits.jerk))
    )
