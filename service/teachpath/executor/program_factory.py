"""Makes the program of a command that starts something: a certified plan, or a live hand that leads the arm."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from teachpath.errors import PathRefused, Unanswered, Unreachable, UnusableInput
from teachpath.executor.certificate_check import CertificateCheck
from teachpath.executor.grasp_monitor import GraspMonitor
from teachpath.executor.joint_state_monitor import JointStateMonitor
from teachpath.executor.settings import ExecutorSettings
from teachpath.executor.station_scene import ask_scene
from teachpath.executor.teleop.hand_input import HandInput
from teachpath.executor.teleop.program import TeleopProgram
from teachpath.io import documents
from teachpath.io.bus import Bus
from teachpath.motion.arm.model import Arm
from teachpath.motion.execution.motion_program import MotionProgram
from teachpath.motion.execution.program import PlanProgram
from teachpath.motion.settings import MotionSettings
from teachpath.records import Command, Plan, Scene, TeleopRequest
from teachpath.records.poses import check_calibration
from teachpath.time_source import TimeSource
from teachpath_proto.control import CommandVerb
from teachpath_proto.keys import Keys

SCALE_RANGE: Final = (0.05, 5.0)  # of the tool's way over the hand's
SHARE_RANGE: Final = (0.05, 1.0)  # of the joints' limits
RESET_TIMEOUT: Final = 15.0  # [s] that the simulated arm may take to build a scene, on a busy machine


@dataclass(frozen=True)
class PreparedProgram:
    """A program that may start.

    Attributes:
        plan: id of its plan; empty with a live hand.
        scene: in which the arm moves.
        confirm: checks that the plan's certificate still holds; raises PathRefused.
        grasp: watches what the gripper holds.
    """

    program: MotionProgram
    plan: str
    scene: Scene
    confirm: Callable[[], None]
    grasp: GraspMonitor


class ProgramFactory:
    """Makes programs that begin where the arm rests.

    Args:
        motion: settings with which plans were made.
        arm: that programs move.
        joint_states: monitor of the arm.
        certificates: refuses plans that may not move the arm.
    """

    def __init__(
        self,
        bus: Bus,
        keys: Keys,
        settings: ExecutorSettings,
        motion: MotionSettings,
        arm: Arm,
        joint_states: JointStateMonitor,
        time_source: TimeSource,
        certificates: CertificateCheck,
    ) -> None:
        self._bus = bus
        self._keys = keys
        self._settings = settings
        self._motion = motion
        self.arm: Arm = arm
        self._joint_states = joint_states
        self._time = time_source
        self._certificates = certificates

    def make(self, command: Command) -> PreparedProgram:
        """Return the program of a `start` or `teleoperate` command.

        Raises:
            UnusableInput: the command holds no plan or request, or one with values outside their ranges.
            PathRefused: the certificate does not hold, the way to the start is not free, the scene is none for a live
                hand, or the service does not answer for it.
            NotFound: the station has no scene of the name.
            Conflict: the arm still moves.
            Unreachable: the arm is silent.
        """
        return self._follow_plan(command) if command.verb == CommandVerb.START else self._follow_hand(command)

    def reset_scene(self, scene: Scene) -> None:
        """Let the simulated arm put its scene back; the driver of a real arm serves no such key.

        Raises:
            Unanswered: it has not done so in time, and may do it when the arm moves already.
        """
        reset = self._keys.reset(self._joint_states.robot)
        try:
            self._bus.ask(reset, documents.encode(scene), timeout=RESET_TIMEOUT)
        except Unanswered as error:
            raise Unanswered(
                f"the simulated arm has not put its object back within {RESET_TIMEOUT:g} s, so nothing starts; is the "
                "machine busy? start again"
            ) from error
        except Unreachable:
            return

    def _follow_plan(self, command: Command) -> PreparedProgram:
        plan = documents.decode(Plan, command.plan)
        self._certificates.verify(plan)
        program = PlanProgram(
            plan,
            self._joint_states.resting_q(self._settings.rest_speed),
            self._motion,
            self.arm,
            override=command.override,
            dwell=self._settings.dwell,
            period=1.0 / self._settings.rate,
        )
        grasp = GraspMonitor.of_plan(plan, self.arm)
        return PreparedProgram(program, plan.id, plan.scene, lambda: self._certificates.confirm(plan), grasp)

    def _follow_hand(self, command: Command) -> PreparedProgram:
        request = documents.decode(TeleopRequest, command.teleop)
        for name, value, (low, high) in (
            ("scale", request.scale, SCALE_RANGE),
            ("share", request.share, SHARE_RANGE),
        ):
            if not low <= value <= high:
                raise UnusableInput(f"{name} {value:g} is outside {low:g} to {high:g}")
        check_calibration(request.calibration)
        only = self._settings.hand_scene
        if only and request.scene != only:
            raise PathRefused(
                f"a live hand leads the arm in scene {only} alone (executor.hand_scene), not in {request.scene}; name "
                "that scene, or set another where another one stands around the arm"
            )
        scene = ask_scene(self._bus, self._keys, request.scene)
        if scene.carried is not None and self.arm.gripper == "suction":
            raise PathRefused(
                f"a live hand leads a suction cup in scenes without an object alone, and {scene.name} has "
                f"{scene.carried.name}: nobody checks how the cup comes upon it; plan a path, or name another scene"
            )
        start_q = self._joint_states.resting_q(self._settings.rest_speed)
        monotonic_ns = self._time.monotonic_ns
        hand = HandInput(self._bus, self._keys, request, silence=self._settings.hand_silence, clock=monotonic_ns)
        try:
            program = TeleopProgram(
                hand,
                request,
                scene,
                start_q,
                self._motion,
                self.arm,
                joint_states=self._joint_states,
                return_timeout=self._settings.hand_return_timeout,
                period=1.0 / self._settings.rate,
                clock=monotonic_ns,
            )
        except BaseException:
            hand.close()
            raise
        return PreparedProgram(program, "", scene, lambda: None, GraspMonitor())
