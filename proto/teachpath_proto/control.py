"""The words of the executor's contract: its states, the verbs that command it, and the actions on the control lease.

They are the same strings on the bus, in REST and in stored documents.
"""

from __future__ import annotations

from enum import StrEnum


class ExecutorState(StrEnum):
    """What an execution does, or how it ended."""

    IDLE = "idle"  # nothing was started yet
    STARTING = "starting"  # the executor has not accepted it yet
    APPROACHING = "approaching"
    FOLLOWING = "following"
    HELD = "held"
    STOPPING = "stopping"  # comes to rest on the path
    ENDED = "ended"
    FAULTED = "faulted"

    @property
    def is_resting(self) -> bool:
        """Whether nothing is under way: another execution may start."""
        return self in (ExecutorState.IDLE, ExecutorState.ENDED, ExecutorState.FAULTED)


class CommandVerb(StrEnum):
    """What the executor may be told to do; motion.proto says what goes with which verb."""

    START = "start"
    OVERRIDE = "override"
    HOLD = "hold"
    RESUME = "resume"
    STOP = "stop"
    REVERSE = "reverse"
    STEP = "step"
    REVOKE = "revoke"
    TELEOPERATE = "teleoperate"
    ACKNOWLEDGE = "acknowledge"


class LeaseAction(StrEnum):
    """What may be done about the control lease."""

    LOOK = "look"
    ACQUIRE = "acquire"
    BEAT = "beat"
    RELEASE = "release"
    ASK = "ask"
    KEEP = "keep"


class JournalVerb(StrEnum):
    """What the journal says that somebody did, or that happened by itself: commands, and of the lease all but beats."""

    START = "start"
    OVERRIDE = "override"
    HOLD = "hold"
    RESUME = "resume"
    STOP = "stop"
    REVERSE = "reverse"
    STEP = "step"
    REVOKE = "revoke"
    TELEOPERATE = "teleoperate"
    ACKNOWLEDGE = "acknowledge"
    ACQUIRE_CONTROL = "acquire control"
    RELEASE_CONTROL = "release control"
    ASK_CONTROL = "ask control"
    KEEP_CONTROL = "keep control"
    UNASKED_MOTION = "unasked motion"  # the arm moved while nothing was under way
