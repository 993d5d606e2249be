"""Commands, the control lease and the journal, with every value checked on the way in."""

from __future__ import annotations

import math
from typing import Final

from teachpath.errors import UnusableInput
from teachpath.io.wire.parsing import parse
from teachpath.records import Command, JournalEntry, Lease, LeaseRequest
from teachpath_proto import motion_pb2
from teachpath_proto.control import CommandVerb, JournalVerb, LeaseAction
from teachpath_proto.keys import is_name, name_refusal

LONGEST_NAME: Final = 64  # characters of a name that everybody is shown
LONGEST_BEAT: Final = 60.0  # [s] between two beats of a lease
LONGEST_STEP: Final = 10.0  # [m]


def encode_command(command: Command) -> bytes:
    """Return the message of a command."""
    fields = {name: getattr(command, name) for name in Command.__dataclass_fields__}
    return motion_pb2.ExecutorCommand(**{**fields, "verb": f"VERB_{command.verb.upper()}"}).SerializeToString()


def decode_command(payload: bytes) -> Command:
    """Check a command; raises UnusableInput."""
    m = parse(motion_pb2.ExecutorCommand, payload)
    if m.verb not in motion_pb2.ExecutorCommand.Verb.values() or not m.verb:
        raise UnusableInput(f"command {m.verb} is unknown: say {', '.join(CommandVerb)}")
    if not 0.0 <= m.override <= 1.0:
        raise UnusableInput(f"override {m.override:g} is outside 0 to 1")
    if not abs(m.length) <= LONGEST_STEP:
        raise UnusableInput(f"a step of {m.length:g} m is over {LONGEST_STEP:g} m; are its units metres?")
    _name(m.who)
    _name(m.id)
    verb = CommandVerb(motion_pb2.ExecutorCommand.Verb.Name(m.verb).removeprefix("VERB_").lower())
    if verb in (CommandVerb.START, CommandVerb.TELEOPERATE) and not is_name(m.execution):
        # Its setpoints carry the name, and a driver follows none that has no name.
        raise UnusableInput(f"{name_refusal('new execution', m.execution)}; each has another one (field execution)")
    return Command(**{name: getattr(m, name) for name in Command.__dataclass_fields__} | {"verb": verb})


def encode_lease_request(request: LeaseRequest) -> bytes:
    """Return the message of a word about control."""
    action = "ACTION_" + ("UNSPECIFIED" if request.action == LeaseAction.LOOK else request.action.upper())
    fields = {name: getattr(request, name) for name in LeaseRequest.__dataclass_fields__}
    return motion_pb2.LeaseRequest(**{**fields, "action": action}).SerializeToString()


def decode_lease_request(payload: bytes) -> LeaseRequest:
    """Check a word about control; raises UnusableInput."""
    m = parse(motion_pb2.LeaseRequest, payload)
    if m.action not in motion_pb2.LeaseRequest.Action.values():
        raise UnusableInput(f"action {m.action} is unknown: say {', '.join(LeaseAction)}")
    name = motion_pb2.LeaseRequest.Action.Name(m.action).removeprefix("ACTION_")
    action = LeaseAction(name.lower()) if m.action else LeaseAction.LOOK
    if action in (LeaseAction.ACQUIRE, LeaseAction.ASK) and not m.name.strip():
        raise UnusableInput("control is held under a name that everybody sees; give one")
    _name(m.name)
    if not (math.isfinite(m.seconds) and 0.0 <= m.seconds <= LONGEST_BEAT):
        raise UnusableInput(f"{m.seconds:g} s between two beats; at most {LONGEST_BEAT:g}")
    return LeaseRequest(**{name: getattr(m, name) for name in LeaseRequest.__dataclass_fields__} | {"action": action})


def encode_lease(lease: Lease) -> bytes:
    """Return the message of who is in control."""
    fields = {name: getattr(lease, name) for name in Lease.__dataclass_fields__}
    return motion_pb2.Lease(**fields).SerializeToString()


def decode_lease(payload: bytes) -> Lease:
    """Return who is in control; raises UnusableInput when malformed."""
    m = parse(motion_pb2.Lease, payload)
    return Lease(**{name: getattr(m, name) for name in Lease.__dataclass_fields__})


def encode_entry(entry: JournalEntry) -> bytes:
    """Return the message of an entry of the journal."""
    fields = {name: getattr(entry, name) for name in JournalEntry.__dataclass_fields__}
    return motion_pb2.JournalEntry(**fields).SerializeToString()


def decode_entry(payload: bytes) -> JournalEntry:
    """Return an entry of the journal; raises UnusableInput when malformed."""
    m = parse(motion_pb2.JournalEntry, payload)
    if m.verb not in list(JournalVerb):
        raise UnusableInput(f"the journal knows no {m.verb[:80]!r}; it has {', '.join(JournalVerb)}")
    fields = {name: getattr(m, name) for name in JournalEntry.__dataclass_fields__}
    return JournalEntry(**fields | {"verb": JournalVerb(m.verb)})


def _name(text: str) -> None:
    if len(text) > LONGEST_NAME or not text.isprintable():
        raise UnusableInput(f"the name {text[:80]!r} has unprintable characters or more than {LONGEST_NAME}")
