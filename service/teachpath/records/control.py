"""What moves the arm by word: commands to the executor, the control lease, and the journal of who did what."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from teachpath.records.calibrations import Calibration
from teachpath_proto.control import CommandVerb, JournalVerb, LeaseAction


@dataclass(frozen=True, slots=True)
class Command:
    """One command to the executor; see teachpath/v1/motion.proto for what goes with which verb."""

    verb: CommandVerb
    execution: str = ""
    plan: bytes = b""  # in JSON
    override: float = 1.0
    length: float = 0.0  # [m]
    nodes: int = 0
    lease: str = ""
    who: str = ""
    plan_id: str = ""
    reason: str = ""
    teleop: bytes = b""  # in JSON
    id: str = ""


@dataclass(frozen=True, slots=True)
class TeleopRequest:
    """A live hand that the arm should follow.

    Attributes:
        tracker: whose samples drive the arm while its clutch is pressed.
        calibration: to the world from its frame.
        scene: name of what stands around the arm; the executor asks the station for it.
        scale: of the tool's way over the hand's, 0.05 to 5.
        share: of the joints' speed, acceleration and jerk limits, 0.05 to 1.
        clutch: tracker whose button bit 2 is the clutch; empty: the hand's own.
        orientation: whether the tool keeps its orientation or follows the hand's, from where both were when the clutch
            was pressed.
        tracker_session: on the bus, whose samples under the tracker's name are followed; empty: that which sends first.
        clutch_session: likewise for the clutch.
    """

    tracker: str
    calibration: Calibration
    scene: str
    scale: float = 1.0
    share: float = 0.5
    clutch: str = ""
    orientation: Literal["keep", "follow"] = "keep"
    tracker_session: str = ""
    clutch_session: str = ""


@dataclass(frozen=True, slots=True)
class LeaseRequest:
    """What somebody does about the control lease; name and seconds belong to `acquire` and `ask`."""

    action: LeaseAction
    name: str = ""
    token: str = ""
    seconds: float = 0.0
    hold_when_lost: bool = False


@dataclass(frozen=True, slots=True)
class Lease:
    """Who is in control; `token` is told only to whom it belongs.

    Attributes:
        holder: who is in control; empty: nobody, everybody may command.
        expires_in: until it lapses without a beat [s].
        hold_when_lost: whether a moving arm is held when the beats stop.
        asking: who asks for control; empty: nobody.
        granted_in: until the one who asks gets it, unless the holder keeps it [s].
        token: for the header Teachpath-Lease; empty for all but the one who acquired or asked.
    """

    holder: str = ""
    expires_in: float = 0.0
    hold_when_lost: bool = False
    asking: str = ""
    granted_in: float = 0.0
    token: str = ""


@dataclass(frozen=True, slots=True)
class JournalEntry:
    """Who did what to the arm, and how that was answered.

    Attributes:
        at_ns: when it was answered [ns since the Unix epoch].
        who: gave the command.
        verb: what was commanded, or what happened by itself.
        execution: id of the execution; empty: none was meant.
        answer: done, or why it was refused or happened.
    """

    at_ns: int
    who: str
    verb: JournalVerb
    execution: str
    answer: str
