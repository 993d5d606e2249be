"""The simulated arm: a dynamic Puma 560 in MuJoCo that follows the setpoints on the bus and says what it does.

It speaks the two keys that a driver of a real arm would speak, and one query that puts the object back to its start.
"""

from __future__ import annotations

import logging
import threading
import time
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Annotated, Final

import mujoco
import numpy as np
from annotated_types import Ge, Gt, Le

from teachpath.errors import UnusableInput
from teachpath.io import documents, wire
from teachpath.io.bus import Bus
from teachpath.motion.mjcf import CARRIED, GRASP, TOOL, mjcf
from teachpath.motion.puma560 import TORQUE
from teachpath.motion.settings import MotionSettings
from teachpath.records import Array, JointState, Quaternion, Scene, Setpoint, Vector
from teachpath_proto.keys import Keys

log = logging.getLogger(__name__)

STEP_NS: Final = 1_000_000
STATE_STEPS: Final = 10  # steps between two joint states: 100 Hz
# A starved process catches up, each setpoint applied when it was due: on a busy machine the arm is late, not wrong.
LAG_NS: Final = 1_000_000_000
AHEAD: Final = 500  # setpoints kept until they are due; with more than that the sender's clock is wrong
ENDED: Final = ("idle", "ended", "faulted")


@dataclass(frozen=True)
class SimulatorSettings:
    """How the simulated arm behaves."""

    # [rad/s] natural frequency of the critically damped tracking error
    bandwidth: Annotated[float, Gt(0), Le(150)] = 60.0
    # [s] between two setpoints; at most this long one is extrapolated
    period: Annotated[float, Gt(0), Le(0.1)] = 0.004
    # [s] that setpoints wait before they are due, so that one that was held up on its way still comes in time
    delay: Annotated[float, Ge(0), Le(0.2)] = 0.03
    # [s] without a setpoint after which the arm holds
    silence: Annotated[float, Gt(0), Le(1)] = 0.02
    # [m] between grasp point and object's centre, up to which a closing gripper takes the object
    reach: Annotated[float, Ge(0), Le(0.2)] = 0.03


class SimulatedArm:
    """The physics: arm, gripper, object and obstacles, advanced by 1 ms a step."""

    def __init__(self, scene: Scene, settings: SimulatorSettings, position: Sequence[float]) -> None:
        """Build the model of `scene`; raises UnusableInput when MuJoCo cannot."""
        try:
            self._model = mujoco.MjModel.from_xml_string(mjcf(scene, timestep=STEP_NS / 1e9))
        except ValueError as error:
            raise UnusableInput(f"scene {scene.name!r} cannot be simulated: {error}") from None
        self._settings, self._start = settings, np.array(position)
        self._carries = scene.carried is not None
        self._friction = np.array(self._model.dof_frictionloss[:6])
        self._acceleration = np.zeros(self._model.nv)
        self._force = np.zeros(self._model.nv)
        self.data = mujoco.MjData(self._model)
        self.reset()

    def reset(self) -> None:
        """Put the arm to where it began, at rest and open, and the object to its start."""
        mujoco.mj_resetData(self._model, self.data)
        self.data.qpos[:6] = self._start
        mujoco.mj_forward(self._model, self.data)

    @property
    def position(self) -> Array:
        """Joint angles (6,) [rad]."""
        return np.array(self.data.qpos[:6])

    @property
    def velocity(self) -> Array:
        """Joint velocities (6,) [rad/s]."""
        return np.array(self.data.qvel[:6])

    @property
    def torque(self) -> Array:
        """Torques of the motors at the joints (6,) [N m]."""
        return np.array(self.data.qfrc_actuator[:6])

    @property
    def object_pose(self) -> tuple[Vector, Quaternion]:
        """Position [m] and orientation of the carried object; all zeros when the scene has none."""
        if not self._carries:
            return (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0)
        x, y, z, w, i, j, k = (float(v) for v in self.data.qpos[6:13])
        return (x, y, z), (w, i, j, k)

    def step(self, position: Array, velocity: Array, acceleration: Array) -> None:
        """Follow the wanted motion for 1 ms by computed torque (Siciliano et al., Robotics, Springer 2009, 8.5.2).

        Coulomb friction is compensated along the wanted velocity, so that the motors do not chatter at rest.
        """
        mujoco.mj_step1(self._model, self.data)
        w = self._settings.bandwidth
        self._acceleration[:6] = (
            acceleration + 2 * w * (velocity - self.data.qvel[:6]) + w**2 * (position - self.data.qpos[:6])
        )
        mujoco.mj_mulM(self._model, self.data, self._force, self._acceleration)
        torque = self._force[:6] + self.data.qfrc_bias[:6] - self.data.qfrc_passive[:6]
        torque += self._friction * np.tanh(velocity / 0.02)
        self.data.ctrl[:6] = np.clip(torque, -TORQUE, TORQUE)
        mujoco.mj_step2(self._model, self.data)

    def grasp(self) -> bool:
        """Take the object as it lies between the fingers; False when it is out of reach and the gripper is empty."""
        if not self._carries:
            return False
        tool = self.data.site(TOOL).xpos
        if np.linalg.norm(tool - self.data.body(CARRIED).xpos) > self._settings.reach:
            return False
        hand, carried = self.data.body("link6"), self.data.body(CARRIED)
        rotation = hand.xmat.reshape(3, 3)
        back, turn = np.empty(4), np.empty(4)
        mujoco.mju_negQuat(back, hand.xquat)
        mujoco.mju_mulQuat(turn, back, carried.xquat)
        weld = self._model.equality(GRASP)
        weld.data[:3] = 0.0  # anchor, in the object
        weld.data[3:6] = rotation.T @ (carried.xpos - hand.xpos)
        weld.data[6:10] = turn
        self.data.eq_active[weld.id] = True
        return True

    def release(self) -> None:
        """Let the object go."""
        if self._carries:
            self.data.eq_active[self._model.equality(GRASP).id] = False


class Simulator:
    """The running arm; `run` is its life, `step` one millisecond of it."""

    def __init__(
        self,
        bus: Bus,
        keys: Keys,
        scene: Scene,
        settings: SimulatorSettings | None = None,
        *,
        robot: str = "puma560",
        home: Sequence[float] = MotionSettings().home,
        clock: Callable[[], int] = time.time_ns,
        sleep: Callable[[float], object] = time.sleep,
    ) -> None:
        """Prepare the arm; nothing runs before `run`.

        Args:
            scene: what stands around the arm until a reset brings another one.
            robot: name of the arm in its keys.
            home: (6,) configuration in which the arm starts [rad].
            clock: nanoseconds since the Unix epoch, the clock of the setpoints.
            sleep: waits for so many seconds.
        """
        self._bus, self._keys, self._robot = bus, keys, robot
        self._settings = settings or SimulatorSettings()
        self._clock, self._sleep = clock, sleep
        self._lock = threading.Lock()
        self._setpoints: deque[bytes] = deque(maxlen=1000)
        self._statuses: deque[bytes] = deque(maxlen=100)
        self._begin(scene, home)

    def run(self, stop: threading.Event) -> None:
        """Live in real time until `stop` is set."""
        robot = self._robot
        handles = [
            self._bus.subscribe(self._keys.setpoint(robot), lambda _, payload: self._setpoints.append(payload)),
            self._bus.subscribe(self._keys.executor_status, lambda _, payload: self._statuses.append(payload)),
            self._bus.serve(self._keys.reset(robot), self.reset),
            self._bus.announce(self._keys.alive("robot", robot)),
        ]
        try:
            due = self._clock()
            while not stop.is_set():
                self.step(due)
                due += STEP_NS
                wait = due - self._clock()
                if abs(wait) > LAG_NS:
                    due = self._clock()
                elif wait > 0:
                    self._sleep(wait / 1e9)
        finally:
            for handle in handles:
                handle.close()

    def reset(self, payload: bytes) -> bytes:
        """Answer the reset query: the object to its start, in the scene given as JSON or the one there is.

        The arm stays where it is, at rest, with its gripper open: no arm ever jumps.

        Returns:
            The joint state after it, as published.

        Raises:
            UnusableInput: the payload is no scene.
        """
        scene = documents.decode(Scene, payload) if payload else self._scene
        with self._lock:
            self._begin(scene, self._arm.position.tolist())
            return wire.encode_state(self._state(self._clock()))

    def step(self, now: int) -> None:
        """Advance by 1 ms from `now` [ns since the Unix epoch]; every tenth time a joint state is published."""
        with self._lock:
            self._read(now)
            position, velocity, acceleration = self._wanted(now)
            self._error = float(np.max(np.abs(position - self._arm.position)))
            state = self._state(now) if self._steps % STATE_STEPS == 0 else None
            self._arm.step(position, velocity, acceleration)
            self._steps += 1
        if state is not None:
            self._bus.publish(self._keys.state(self._robot), wire.encode_state(state))

    def _begin(self, scene: Scene, position: Sequence[float]) -> None:
        self._arm = SimulatedArm(scene, self._settings, position)
        self._scene = scene
        self._queue: deque[Setpoint] = deque()  # come, but not due yet
        self._setpoints.clear()
        self._newest: Setpoint | None = None
        self._held = self._arm.position
        self._applied = 0  # [ns] when the newest setpoint was applied
        self._gaps = 0
        self._over = ""  # the execution that said that it has ended
        self._closed = False
        self._error = 0.0
        self._steps = 0

    def _read(self, now: int) -> None:
        try:
            while self._setpoints:
                self._queue.append(wire.decode_setpoint(self._setpoints.popleft()))
            while self._statuses:
                status = wire.decode_status(self._statuses.popleft())
                if status.state in ENDED:
                    self._over = status.execution
        except UnusableInput as error:
            log.warning("left out: %s", error)
        while self._queue and (self._due(self._queue[0]) <= now or len(self._queue) > AHEAD):
            self._apply(self._queue.popleft(), now)

    def _due(self, setpoint: Setpoint) -> int:
        return setpoint.nominal_ns + round(self._settings.delay * 1e9)

    def _apply(self, setpoint: Setpoint, now: int) -> None:
        newest = self._newest
        if newest is None or newest.execution != setpoint.execution:
            self._gaps = 0
        elif setpoint.cycle <= newest.cycle:
            return
        else:
            self._gaps += setpoint.cycle - newest.cycle - 1
        if setpoint.gripper_closed and not self._closed:
            self._arm.grasp()
        elif self._closed and not setpoint.gripper_closed:
            self._arm.release()
        self._closed = setpoint.gripper_closed
        self._newest, self._applied = setpoint, now

    def _wanted(self, now: int) -> tuple[Array, Array, Array]:
        """Extrapolate the newest setpoint by at most one period; on silence hold the last wanted position."""
        newest, none = self._newest, np.zeros(6)
        if newest is None or self._silent(now):
            return self._held, none, none
        dt = min(max((now - self._due(newest)) / 1e9, 0.0), self._settings.period)
        velocity = newest.velocity + newest.acceleration * dt
        self._held = newest.position + newest.velocity * dt + newest.acceleration * dt**2 / 2
        return self._held, velocity, newest.acceleration

    def _silent(self, now: int) -> bool:
        return now - self._applied > self._settings.silence * 1e9

    def _state(self, now: int) -> JointState:
        holding = self._newest is not None and self._newest.execution != self._over and self._silent(now)
        overdue = int((now - self._applied) / 1e9 / self._settings.period) if holding else 0
        place, turn = self._arm.object_pose
        return JointState(
            stamp_ns=now,
            cycle=self._newest.cycle if self._newest is not None else 0,
            position=self._arm.position,
            velocity=self._arm.velocity,
            torque=self._arm.torque,
            tracking_error=self._error,
            missed=self._gaps + overdue,
            holding=holding,
            gripper_closed=self._closed,
            object_position=place,
            object_orientation=turn,
            execution=self._newest.execution if self._newest is not None else "",
        )
