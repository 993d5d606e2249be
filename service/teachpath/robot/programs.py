"""Motions that leave the station as files: plans whose certificate holds, and executions as they were recorded."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from teachpath.errors import Conflict, PathRefused, UnusableInput
from teachpath.io.programs.formats import check_rate, format_named
from teachpath.io.store.motions import read_motion
from teachpath.io.store.store import Store
from teachpath.motion.analysis.sampled_execution import recorded_duration, sample_setpoints
from teachpath.motion.arm.model import Arm
from teachpath.motion.planning.plan_notes import arm_notes
from teachpath.motion.planning.signature import SigningKey, certified_arm, verify_signature
from teachpath.motion.settings import MotionSettings
from teachpath.records import Plan
from teachpath.robot.executions import Executions


@dataclass(frozen=True)
class ProgramFile:
    """A motion as a file: its name, its media type and its content."""

    name: str
    media_type: str
    content: bytes


class Programs:
    """Writes plans and executions in the formats of other programs.

    Args:
        store: that has the plans.
        key: of the station.
        motion: settings for which certificates have to hold.
        arm: of the station.
        executions: of the station.
        call: calls a function with arguments, in a process that is limited in memory and time.
        clock: returns nanoseconds since the Unix epoch.
    """

    def __init__(
        self,
        store: Store,
        key: SigningKey,
        motion: MotionSettings,
        arm: Arm,
        executions: Executions,
        call: Callable[..., Any],
        clock: Callable[[], int],
    ) -> None:
        self._store = store
        self._key = key
        self._motion = motion
        self._arm = arm
        self._executions = executions
        self._call = call
        self._clock = clock

    def of_plan(self, plan: str, format: str, rate: float | None) -> ProgramFile:
        """Write a plan, at `rate` instants a second [Hz] or as many as the format usually has.

        Raises:
            NotFound: no such plan.
            PathRefused: its certificate does not hold, or was revoked.
            UnusableInput: an unknown format, or a rate that cannot be.
        """
        kind = format_named(format)
        stored = self._store.plan(plan)
        if reason := self._store.journal.revoked(stored.id):
            raise PathRefused(f"the certificate of {stored.id} was revoked: {reason}; plan the path again")
        verify_signature(stored, self._arm, self._motion, self._key, self._clock())
        content = self._call(write_plan, stored, format, kind.rate if rate is None else rate, self._arm)
        return ProgramFile(stored.id + kind.suffix, kind.media_type, content)

    def of_execution(self, execution: str, format: str, rate: float | None) -> ProgramFile:
        """Write what the arm was sent in an execution that has ended.

        Raises:
            NotFound: no such execution, or it has no recording.
            Conflict: it has not ended.
            UnusableInput: an unknown format, or a rate that cannot be.
        """
        kind = format_named(format)
        if kind.certified_only:
            raise UnusableInput(
                f"a program in {format} moves a robot, so it is made of a certified plan alone; take the execution as "
                "csv, json, cdr or mcap, or its plan as a program"
            )
        row = self._executions.get(execution)
        if not row.status.state.is_resting:
            raise Conflict(f"execution {row.id} is {row.status.state}; ask again when it has ended")
        recording = self._executions.recording(row.id)
        content = self._call(write_execution, recording, row.id, format, kind.rate if rate is None else rate, self._arm)
        return ProgramFile(row.id + kind.suffix, kind.media_type, content)


def write_plan(plan: Plan, format: str, rate: float, arm: Arm) -> bytes:
    """Return the content of a plan's file; raises as `Programs.of_plan`."""
    from teachpath.motion.planning.sampled_plan import (
        sample_plan,
    )  # with libraries that the service itself does not need

    check_rate(rate, plan.duration)
    return format_named(format).write(sample_plan(plan, rate, arm))


def write_execution(recording: Path, name: str, format: str, rate: float, arm: Arm) -> bytes:
    """Return the content of an execution's file; raises as `Programs.of_execution`."""
    motion = read_motion(recording)
    check_rate(rate, recorded_duration(motion.setpoints))
    plan = motion.header.plan if motion.header else None
    moved = (plan and certified_arm(plan, arm)) or arm
    notes = (
        f"Execution {name}: the {len(motion.setpoints)} setpoints that were sent"
        + (f" to follow plan {plan.id}." if plan else " to follow a live hand."),
        "It is what was recorded, holds and changes of speed included; no certificate covers it as a whole.",
        *arm_notes(moved),
    )
    return format_named(format).write(sample_setpoints(motion.setpoints, rate, name, notes, moved.limits.names))
