"""The simulated arm: a dynamic arm that follows the setpoints on the bus and publishes its joint state.

It uses the two keys that the driver of a real arm uses, and answers one query that puts the object back to its start.
"""

from __future__ import annotations

import logging
import threading
from collections import deque
from collections.abc import Sequence
from typing import Final

import numpy as np

from teachpath.errors import Conflict, UnusableInput
from teachpath.io import documents, wire
from teachpath.io.bus import Bus
from teachpath.io.bus_delivery import Delivery
from teachpath.motion.arm.model import Arm
from teachpath.motion.settings import MotionSettings
from teachpath.realtime import SIMULATOR_PRIORITY, realtime_threads, request_realtime
from teachpath.records import JointState, Scene
from teachpath.simulator.arm import STEP_NS, SimulatedArm
from teachpath.simulator.settings import SimulatorSettings
from teachpath.time_source import TimeSource
from teachpath_client.driver import PlayerState, SetpointPlayer
from teachpath_proto.keys import Keys

log: logging.Logger = logging.getLogger(__name__)

STEPS_PER_STATE: Final = 10  # steps between two joint states: 100 Hz
REST_STEPS_BEFORE_IDLE: Final = 200  # steps of standstill after which no physics is computed any more
IDLE_STATE_PERIOD: Final = 0.04  # [s] between two joint states then: 25 Hz, where the contract asks for 20
# Lag up to which a process that got no processor time catches up, step by step: on a busy machine the arm is late, but
# its motion is right.
MAX_LAG_NS: Final = 1_000_000_000
ABANDONED_NS: Final = 200_000_000  # [ns] without setpoints, after which an arm at rest is nobody's


class Simulator:
    """The running arm: `run` advances it in real time, `step` by one millisecond."""

    def __init__(
        self,
        bus: Bus,
        keys: Keys,
        scene: Scene,
        settings: SimulatorSettings | None = None,
        *,
        robot: str = "puma560",
        home: Sequence[float] = MotionSettings().home,
        arm: Arm | None = None,
        time_source: TimeSource | None = None,
    ) -> None:
        """Prepare the arm; nothing runs before `run`.

        Args:
            scene: what stands around the arm until a reset brings another one.
            robot: name of the arm in its keys.
            home: (joints,) configuration in which the arm starts [rad].
            arm: that is simulated; the default variant when None.
            time_source: the machine's clocks by default.
        """
        self._bus = bus
        self._keys = keys
        self._robot = robot
        self._settings = settings or SimulatorSettings()
        self._model = arm or Arm.of_variant()
        self._time = time_source or TimeSource()
        self._clock = self._time.wall_ns  # the clock of the setpoints
        self._wake = threading.Event()
        self._rest_steps = 0  # number of newest steps in which everything stood still
        self._lock = threading.Lock()
        self._setpoints: deque[bytes] = deque(maxlen=1000)
        self._statuses: deque[bytes] = deque(maxlen=100)
        self._build(scene, home)

    def run(self, stop: threading.Event) -> None:
        """Advance in real time until `stop` is set."""
        robot = self._robot
        with realtime_threads(self._settings.realtime):
            handles = [
                self._bus.subscribe(self._keys.setpoint(robot), lambda _, payload: self.receive(payload)),
                self._bus.subscribe(self._keys.executor_status, lambda _, payload: self._statuses.append(payload)),
            ]
        handles += [
            self._bus.serve(self._keys.reset(robot), self.reset),
            self._bus.announce(self._keys.alive("robot", robot)),
        ]
        if self._settings.realtime:
            log.info("%s", request_realtime(SIMULATOR_PRIORITY))
        try:
            due = self._clock()
            while not stop.is_set():
                if self._is_idle:
                    due = self._idle(due)
                    continue
                self.step(due)
                due += STEP_NS
                wait = due - self._clock()
                if abs(wait) > MAX_LAG_NS:
                    due = self._clock()
                elif wait > 0:
                    self._time.sleep(wait / 1e9)
        finally:
            for handle in handles:
                handle.close()

    def reset(self, payload: bytes) -> bytes:
        """Put the object back to its start; the payload is a scene in JSON, or empty for the present scene.

        The arm stays where it is, at rest and with its gripper open, because no arm ever jumps. While an execution is
        under way the scene must not change, because the certificate holds for this one.

        Returns:
            The message of the joint state afterwards.

        Raises:
            UnusableInput: the payload is no scene.
            Conflict: an execution is under way.
        """
        scene = documents.decode(Scene, payload) if payload else self._scene
        with self._lock:
            self._read_statuses()
            moving = self._player.execution
            if moving not in ("", self._finished_execution) and not self._is_abandoned(self._time.wall_ns()):
                raise Conflict(f"execution {moving} is under way in scene {self._scene.name}; stop it first")
            self._build(scene, self._arm.position.tolist())
            self._wake.set()
            return wire.encode_state(self._state(self._clock()))

    def receive(self, payload: bytes) -> None:
        """Take the message of a setpoint, for the next step."""
        self._setpoints.append(payload)
        self._wake.set()

    def step(self, now: int) -> None:
        """Advance by 1 ms from `now` [ns since the Unix epoch]; publish a joint state in every tenth step."""
        with self._lock:
            self._read_setpoints(now)
            target = self._player.target
            self._tracking_error = float(np.max(np.abs(target.position - self._arm.position)))
            state = self._state(now) if self._steps % STEPS_PER_STATE == 0 else None
            self._arm.step(target.position, target.velocity, target.acceleration)
            self._steps += 1
            self._rest_steps = self._rest_steps + 1 if self._player.at_rest and self._arm.at_rest else 0
        if state is not None:
            self._publish(state)

    @property
    def _is_idle(self) -> bool:
        """Whether arm and object have stood still for a while and no setpoint has come."""
        return self._rest_steps >= REST_STEPS_BEFORE_IDLE and not self._setpoints

    def _idle(self, since: int) -> int:
        """Wait for a setpoint or until the next joint state is due, and return the time then [ns since the Unix epoch].

        No physics is computed: what stands still under constant torques goes on standing still.
        """
        with self._lock:
            state = self._state(since)
        self._publish(state)
        self._time.wait(self._wake, IDLE_STATE_PERIOD)
        self._wake.clear()
        now = self._clock()
        with self._lock:
            self._read_statuses()
            if now > since:  # the clock may be set back
                self._player.advance((now - since) / 1e9, now)
        return now

    def _publish(self, state: JointState) -> None:
        payload = wire.encode_state(state)
        self._bus.publish(self._keys.state(self._robot), payload, delivery=Delivery.DROPS)  # an arm never waits

    def _build(self, scene: Scene, position: Sequence[float]) -> None:
        settings = self._settings
        self._arm = SimulatedArm(scene, self._model, settings, position)
        self._scene = scene
        self._last_setpoint_ns = 0
        self._player = SetpointPlayer(self._arm.position, delay=settings.delay)
        self._setpoints.clear()
        self._finished_execution = ""  # id of the execution whose end the executor has published
        self._gripper_closed = False
        self._tracking_error = 0.0
        self._steps = 0
        self._rest_steps = 0

    def _read_setpoints(self, now: int) -> None:
        try:
            while self._setpoints:
                self._player.add(wire.decode_setpoint(self._setpoints.popleft()), now)
                self._last_setpoint_ns = now
        except UnusableInput as error:
            log.warning("left out: %s", error)
        self._read_statuses()
        reached = self._player.advance(STEP_NS / 1e9, now)
        if reached is not None:
            self._move_gripper(reached.gripper_closed)

    def _read_statuses(self) -> None:
        """Read the executor's statuses."""
        try:
            while self._statuses:
                status = wire.decode_status(self._statuses.popleft())
                if status.state.is_resting:
                    self._finished_execution = status.execution
        except UnusableInput as error:
            log.warning("left out: %s", error)

    def _move_gripper(self, closed: bool) -> None:
        if closed and not self._gripper_closed:
            self._arm.grasp()
        elif self._gripper_closed and not closed:
            self._arm.release()
        self._gripper_closed = closed

    def _is_abandoned(self, now: int) -> bool:
        """Whether the arm rests and its executor has sent nothing for a while: it may have died."""
        return self._player.at_rest and now - self._last_setpoint_ns > ABANDONED_NS

    @property
    def _holds(self) -> bool:
        """Whether the arm follows a way to rest, or rests at its end."""
        return self._player.state in (PlayerState.STOPPING, PlayerState.STOPPED)

    def _state(self, now: int) -> JointState:
        player, newest = self._player, self._player.last_reached
        holding = newest is not None and newest.execution != self._finished_execution and self._holds
        position, orientation = self._arm.object_pose
        return JointState(
            stamp_ns=now,
            cycle=newest.cycle if newest is not None else 0,
            position=self._arm.position,
            velocity=self._arm.velocity,
            torque=self._arm.torque,
            tracking_error=self._tracking_error,
            missed=player.missed,
            holding=holding,
            gripper_closed=self._gripper_closed,
            gripper_opening=self._arm.gripper_opening,
            output=player.output,
            object_position=position,
            object_orientation=orientation,
            execution=newest.execution if newest is not None else "",
            late=player.late,
            stopped=holding and player.state is PlayerState.STOPPED,
        )
