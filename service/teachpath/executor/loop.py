"""The executor: streams the setpoints of one execution at a time to the arm, and obeys the operator meanwhile.

It runs in a process of its own. The control loop never raises in mid-motion, and waits for nobody who reads nothing:
whatever goes wrong brings the arm to rest on its path, with a reason in the status.
"""

from __future__ import annotations

import gc
import logging
import threading
from dataclasses import replace
from typing import Final

import numpy as np

from teachpath.executor.certificate_check import CertificateCheck
from teachpath.executor.command_handler import CommandHandler
from teachpath.executor.execution import Execution
from teachpath.executor.joint_state_monitor import JointStateMonitor, SetpointStallDetector
from teachpath.executor.pacing import Pacer
from teachpath.executor.program_factory import ProgramFactory
from teachpath.executor.settings import ExecutorSettings
from teachpath.executor.unasked_motion import UnaskedMotionDetector, moved_since_order
from teachpath.io import wire
from teachpath.io.bus import Bus
from teachpath.io.bus_delivery import Delivery
from teachpath.motion.arm.model import Arm
from teachpath.motion.execution.governor import warm_up
from teachpath.motion.execution.hand_kinematics import warm_up_hand
from teachpath.motion.planning.signature import SigningKey
from teachpath.motion.settings import MotionSettings
from teachpath.realtime import EXECUTOR_PRIORITY, realtime_threads, request_realtime
from teachpath.records import ExecutorStatus, JointState
from teachpath.time_source import TimeSource
from teachpath_proto.control import ExecutorState, JournalVerb
from teachpath_proto.keys import Keys

log: logging.Logger = logging.getLogger(__name__)

IDLE_PERIODS: Final = 5  # control periods in one cycle of the loop while no execution is under way
# [Hz] of the status at most while no execution is under way; an executor that is silent for a second counts as gone
IDLE_STATUS_RATE: Final = 4.0


class Executor:
    """Owns the control loop, which `run` runs."""

    def __init__(
        self,
        bus: Bus,
        keys: Keys,
        settings: ExecutorSettings | None = None,
        *,
        signing_key: SigningKey,
        robot: str = "puma560",
        motion: MotionSettings | None = None,
        arm: Arm | None = None,
        time_source: TimeSource | None = None,
    ) -> None:
        """Prepare the executor; nothing runs before `run`.

        Args:
            signing_key: of the station; plans that it did not sign are refused.
            robot: name of the arm in its keys.
            arm: that is moved; the published variant that `motion` names by default.
            time_source: paces the loop and stamps the setpoints; the machine's clocks by default.
        """
        self._bus = bus
        self._keys = keys
        self._robot = robot
        self._settings = settings or ExecutorSettings()
        self._time = time_source or TimeSource()
        self._period = 1.0 / self._settings.rate
        self._pacer = Pacer(round(1e9 * self._period), self._time)
        self._stall_detector = SetpointStallDetector()
        self._unasked = UnaskedMotionDetector(self._settings.unasked_motion, self._settings.silence)
        motion = motion or MotionSettings()
        self._arm = arm or Arm.of_settings(motion)
        self._joint_states = JointStateMonitor(
            robot, self._arm.joint_count, self._settings.silence, self._time.monotonic_ns
        )
        certificates = CertificateCheck(bus, keys, signing_key, motion, self._arm, self._time)
        programs = ProgramFactory(
            bus, keys, self._settings, motion, self._arm, self._joint_states, self._time, certificates
        )
        self._command_handler = CommandHandler(
            bus,
            keys,
            self._settings,
            self._joint_states,
            programs,
            time_source=self._time,
            status=self._status,
            unasked_motion=self._unasked,
            on_start=self._pacer.reset,
        )
        self._scheduling = "real-time scheduling was not asked for"
        self._published = ("", "", False, 0)  # execution, state, whether it ends, and time of the newest status

    def run(self, stop: threading.Event) -> None:
        """Stream setpoints until `stop` is set; then bring the arm to rest on its path and return."""
        warm_up(self._period, self._arm)
        warm_up_hand(self._arm)
        with realtime_threads(self._settings.realtime):
            handles = [
                self._bus.subscribe(self._keys.state(self._robot), self._joint_states.receive),
                self._bus.watch(self._keys.alive("robot", self._robot), self._joint_states.on_liveliness),
                self._command_handler.receive_stops(),
            ]
        handles += [
            *self._command_handler.serve(),
            self._bus.announce(self._keys.alive("executor", self._robot)),
        ]
        if self._settings.realtime:
            self._scheduling = request_realtime(EXECUTOR_PRIORITY)
        log.info("%s", self._scheduling)
        # A collection in the loop can last a hundred periods; nothing in this process makes cyclic garbage in bulk.
        gc.collect()
        gc.freeze()
        gc.disable()
        handler = self._command_handler
        try:
            self._cycle(self._pacer.wait(counted=False))  # publishes the first status at once
            while not (stop.is_set() and handler.is_resting):
                if stop.is_set() and handler.current is not None:
                    handler.current.end(ExecutorState.ENDED, "the executor was told to stop")
                if handler.is_resting:
                    self._cycle(self._pacer.wait(IDLE_PERIODS, counted=False, woken=handler.stop_came))
                else:
                    self._cycle(self._pacer.wait())
        finally:
            gc.enable()
            gc.unfreeze()
            for handle in handles:
                handle.close()

    def _cycle(self, due: int) -> None:
        self._joint_states.look(due)
        self._command_handler.obey_stops()
        current = self._command_handler.current
        if current is not None and not (current.has_begun or current.is_resting):
            self._look_before_start(current, due)
        if current is not None and not current.is_resting:
            pending = self._command_handler.pending
            while pending:
                pending.popleft()(current)
            self._supervise(current, due)
            current.watch_rest(self._speaking_arm(due), self._joint_states.listened_ns)
            if current.displacement or current.arm_stops:
                current.skip_period()
            else:
                setpoint = current.step(due, self._time.wall_ns())
                payload = wire.encode_setpoint(setpoint)
                self._bus.publish(self._keys.setpoint(self._robot), payload, delivery=Delivery.DROPS)
                current.program.advance_planning()
            self._unasked.forget()
        else:
            self._watch_resting_arm(due)
        self._publish_status(due)

    def _look_before_start(self, current: Execution, due: int) -> None:
        """Refuse an execution before its first setpoint when the arm has moved since it was ordered."""
        self._watch_resting_arm(due)
        arm = self._speaking_arm(due)
        off = float(np.abs(arm.position - current.program.current_q).max()) if arm is not None else 0.0
        if self._unasked.reason:
            current.refuse(self._unasked.reason)
        elif off > self._settings.unasked_motion:
            current.refuse(moved_since_order(off))

    def _watch_resting_arm(self, due: int) -> None:
        latest = self._joint_states.latest(due)
        if latest is None:  # no arm spoke yet, or its driver has ended: the next one rests where it is found
            self._unasked.forget()
        elif sentence := self._unasked.update(due, *latest):
            self._command_handler.write_journal("the arm", JournalVerb.UNASKED_MOTION, sentence, execution="")
            self._command_handler.status_is_due = True

    def _supervise(self, current: Execution, due: int) -> None:
        lost = self._command_handler.lease.pop_lost_holder()
        if lost:
            self._hold(current, f"nothing was heard of {lost}, who was in control; resume when somebody is there again")
        arm = self._speaking_arm(due)
        if arm is None:
            self._supervise_silence(current, due)
        else:
            self._supervise_arm(current, arm, due)

    def _speaking_arm(self, due: int) -> JointState | None:
        """Return the newest joint state, or None when the arm is silent or its driver has ended."""
        latest = self._joint_states.latest(due)
        if latest is None or latest[0] > self._settings.silence or self._joint_states.has_lost_driver:
            return None
        return latest[1]

    def _supervise_silence(self, current: Execution, due: int) -> None:
        """Hold an arm that is silent; end its execution when it stays so, and soon when its driver has ended."""
        current.arm_stops = False  # nobody says any more that it comes to rest
        absence = self._joint_states.absence(due, self._settings.silence_timeout, self._bus.is_joined)
        if absence.is_final:
            current.end(ExecutorState.FAULTED, f"{absence.reason} look where the arm stands, then start again")
        else:
            self._hold(current, f"{absence.reason} resume when it is back")

    def _supervise_arm(self, current: Execution, arm: JointState, due: int) -> None:
        if arm.fault:
            current.end(ExecutorState.FAULTED, f"{arm.inability}, then start again")
        elif arm.inability:
            self._hold(current, f"{arm.inability}; then resume")
        self._judge_grasp(current, arm, due)
        if self._follows_way_to_rest(current, arm, due):
            return
        untaken = current.untaken(arm) / self._settings.rate
        stalled = self._stall_detector.stall_duration(due, current.id, arm, untaken)
        has_stalled = stalled > self._settings.setpoint_timeout
        if current.is_settled or current.displacement:
            if current.arm_has_stopped(arm) or has_stalled:  # otherwise the arm is late, and still moves
                off = float(np.abs(arm.position - current.program.current_q).max())
                current.displacement = off if off > self._settings.regain else 0.0
            if current.displacement:
                self._stall_detector.restart(due)
            return
        if has_stalled:
            why = f"the arm has taken up no setpoint for {stalled:.1f} s"
            self._hold(current, f"{why}: does its driver hear them? resume when it does")
        current.wait_for_late_arm(arm)
        if arm.execution == current.id:
            self._judge_tracking(current, current.tracking.measure(arm))

    def _follows_way_to_rest(self, current: Execution, arm: JointState, due: int) -> bool:
        """Wait for an arm that comes to rest because setpoints were late, and go on from where it rests."""
        holds = arm.holding and arm.execution == current.id and not current.displacement
        if not holds or current.has_restarted(arm.cycle, due):
            current.arm_stops = False
            return False
        current.arm_stops = True
        if not arm.stopped:
            return True
        if not current.restart(arm.cycle, due):  # it is so long ago that the arm has to be brought back
            current.arm_stops = False
            self._hold(current, "setpoints were late, and the arm came to rest; resume brings it back to the path")
            return False
        self._stall_detector.restart(due)
        reason = f"setpoints were late {current.program.location}: the arm came to rest"
        goes_on = "" if current.program.held else ", and goes on from there"
        self._command_handler.write_journal("the arm", JournalVerb.HOLD, reason + goes_on)
        return True

    def _hold(self, current: Execution, reason: str) -> None:
        if not current.program.hold_requested:
            self._command_handler.write_journal("the executor", JournalVerb.HOLD, reason)
        current.hold(reason)

    def _judge_grasp(self, current: Execution, arm: JointState, due: int) -> None:
        if arm.execution != current.id:
            return
        closed, carries = current.program.state.gripper_closed, not current.program.before_path
        fault = current.grasp.fault(arm, closed=closed, carries=carries, now=due)
        if fault and self._settings.failed_grasp == "fault":
            way_out = f"put {current.grasp.name} where the path begins, then start again"
            current.end(ExecutorState.FAULTED, f"{fault}: {way_out}")
        elif fault and not current.is_ending:
            reason = f"{fault}: resume goes on as it is, stop ends here"
            self._hold(current, reason)
            current.reason = reason  # also where it was held already, for another reason

    def _judge_tracking(self, current: Execution, error: float) -> None:
        if error > self._settings.largest_error:
            current.end(
                ExecutorState.FAULTED,
                f"tracking error {error:.3f} rad {current.program.location}, limit "
                f"{self._settings.largest_error:g}: is the arm blocked? free it, or start again at a lower override",
            )

    def _publish_status(self, due: int) -> None:
        """Publish the status: at once when the state has changed or a stop came, otherwise at an even rate."""
        handler, current = self._command_handler, self._command_handler.current
        state = (current.id, current.state, current.is_ending) if current else ("", ExecutorState.IDLE, False)
        rate = self._settings.status_rate
        if handler.is_resting:
            rate = min(rate, IDLE_STATUS_RATE)
        is_due, handler.status_is_due = handler.status_is_due, False
        if not is_due and state == self._published[:3] and due - self._published[3] < 1e9 / rate:
            return
        self._published = (*state, due)
        self._bus.publish(self._keys.executor_status, wire.encode_status(self._status()), delivery=Delivery.DROPS)

    def _status(self) -> ExecutorStatus:
        current, lease = self._command_handler.current, self._command_handler.lease.public_view()
        status = current.status(self._pacer) if current is not None else ExecutorStatus()
        return replace(
            status,
            operator=lease.holder,
            asking=lease.asking,
            scheduling=self._scheduling,
            unasked_motion=self._unasked.reason,
        )
