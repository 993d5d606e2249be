"""What the arm was told and did: one MCAP file an execution, with setpoints, joint states, statuses and journal.

Like a demonstration's file it ends in `.part` while it is written, is flushed every second, and its first record says
what it is of; so it can be read after a crash, and judged without the station that wrote it.
"""

from __future__ import annotations

import os
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, BinaryIO, Final

from mcap.records import Channel, Header, Message, Metadata
from mcap.writer import Writer
from mcap_protobuf.schema import register_schema

from teachpath.errors import NotFound, UnusableRecording
from teachpath.io import documents, wire
from teachpath.io.store.mcap_records import open_records
from teachpath.io.store.recordings import Opener, open_new
from teachpath.io.wire import message_types
from teachpath.records import ExecutorStatus, JointState, JournalEntry, LearnedPath, Plan, Setpoint

HEADER, FACTS = "teachpath-motion", "facts"  # names of the metadata
REPAIR_SUFFIX: Final = ".mending"  # ends the name of what is made of a torn file
CHUNK: Final = 64 * 1024  # bytes; small chunks lose less when a file is cut off
FORMER_NAMES: Final = {"pace": "squared_rates"}  # what files that were recorded earlier call the fields of a plan
TOPICS: Final[dict[str, tuple[Any, Any]]] = {  # message, decoder
    "setpoints": (message_types.SETPOINT, wire.decode_setpoint),
    "states": (message_types.JOINT_STATE, wire.decode_state),
    "statuses": (message_types.EXECUTOR_STATUS, wire.decode_status),
    "journal": (message_types.JOURNAL_ENTRY, wire.decode_entry),
}


@dataclass(frozen=True, eq=False)
class MotionHeader:
    """What a recorded motion is of; plan and path are None when the arm followed a live hand."""

    execution: str
    robot: str
    plan: Plan | None = None
    path: LearnedPath | None = None


@dataclass(eq=False)
class Motion:
    """A recorded motion as read; `fault` says what ended the reading of a torn file, or nothing."""

    header: MotionHeader | None = None
    setpoints: list[Setpoint] = field(default_factory=list)
    states: list[JointState] = field(default_factory=list)
    statuses: list[tuple[int, ExecutorStatus]] = field(default_factory=list)  # with the time they came [ns]
    journal: list[JournalEntry] = field(default_factory=list)
    facts: dict[str, str] = field(default_factory=dict)
    fault: str = ""


class MotionTake:
    """A motion that is being written."""

    def __init__(self, part: Path, header: MotionHeader, opener: Opener = open_new) -> None:
        self._part = part
        self._file = opener(part)
        try:
            self._writer = Writer(self._file, chunk_size=CHUNK)
            self._writer.start(profile="", library="teachpath")
            self._writer.add_metadata(HEADER, {"header": documents.encode(header).decode()})
            self._channels = {
                topic: self._writer.register_channel(
                    topic=topic, message_encoding="protobuf", schema_id=register_schema(self._writer, kind)
                )
                for topic, (kind, _) in TOPICS.items()
            }
            self.flush()
        except OSError:
            self.leave()
            self._part.unlink(missing_ok=True)  # an empty file tells nothing
            raise

    def write(self, topic: str, payload: bytes, at_ns: int) -> None:
        """Append one message as it came."""
        self._writer.add_message(self._channels[topic], log_time=at_ns, data=payload, publish_time=at_ns)

    def flush(self) -> None:
        """Hand all that was written to the operating system; a killed process loses none of it."""
        self._writer.flush()  # type: ignore[no-untyped-call]

    def finish(self, facts: dict[str, str]) -> Path:
        """End the file with `facts` (counts) and return its final name."""
        self._writer.add_metadata(FACTS, facts)
        self._writer.finish()  # type: ignore[no-untyped-call]
        self._file.flush()
        os.fsync(self._file.fileno())
        self._file.close()
        return self._part.rename(self._part.with_suffix(""))

    def leave(self) -> None:
        """Stop writing and leave the unfinished file."""
        with suppress(OSError):
            self._file.close()


class Motions:
    """The folder of recorded motions; `opener` opens a new file in it."""

    def __init__(self, root: Path, opener: Opener = open_new) -> None:
        self._root, self._opener = root, opener

    def begin(self, header: MotionHeader) -> MotionTake:
        """Open the file of a new execution."""
        return MotionTake(self._root / f"{header.execution}.mcap.part", header, self._opener)

    def path(self, execution: str) -> Path:
        """Return the file of an execution that is stored, whole or still being written; raises NotFound."""
        for name in (f"{execution}.mcap", f"{execution}.mcap.part"):
            if (file := self._root / name).is_file():
                return file
        raise NotFound(f"execution {execution} has no recording; it was refused before it began, or recorded elsewhere")

    def unfinished(self) -> list[Path]:
        """List the files that are being written, or that a crash left."""
        return sorted(self._root.glob("*.mcap.part"))

    def finished(self) -> list[Path]:
        """List the files of executions that ended."""
        return sorted(self._root.glob("*.mcap"))

    def mend(self, part: Path) -> Path:
        """Make a whole file of all that is in a torn one, beside which the torn one stays as `.torn`.

        Raises:
            UnusableRecording: not even its header can be read.
        """
        header = read_motion(part).header
        if header is None:
            raise UnusableRecording(f"{part.name} was cut off before its first record")
        mended = part.with_suffix(REPAIR_SUFFIX)
        mended.unlink(missing_ok=True)  # of a doctor or service that was killed
        take = MotionTake(mended, header, self._opener)
        fault = ""
        with part.open("rb") as stream:
            try:
                for topic, message in _messages(stream, Motion()):
                    take.write(topic, message.data, message.log_time)
            except Exception as error:  # damage shows as whatever the reader or its decompressor raises
                fault = str(error) or type(error).__name__
        whole = take.finish({"mended": fault or "it had no end"})
        part.rename(part.with_suffix(".torn"))
        return whole


def read_motion(file: Path) -> Motion:
    """Read a recorded motion, torn or whole; what cannot be read ends the reading with its `fault`."""
    motion = Motion()
    with file.open("rb") as stream:
        try:
            for topic, message in _messages(stream, motion):
                record = TOPICS[topic][1](message.data)
                kept: list[Any] = getattr(motion, topic)
                kept.append((message.log_time, record) if topic == "statuses" else record)
        except OSError:
            raise
        except Exception as error:  # damage shows as whatever the reader or its decompressor raises
            motion.fault = str(error) or type(error).__name__
    return motion


def _messages(stream: BinaryIO, motion: Motion) -> Any:
    """Yield (topic, message) of every message of ours; header and facts go into `motion`."""
    ours: dict[int, str] = {}
    for number, record in enumerate(open_records(stream)):
        if number == 0 and not isinstance(record, Header):
            raise UnusableRecording("it has no MCAP header")
        if isinstance(record, Metadata) and record.name == HEADER:
            motion.header = documents.decode(
                MotionHeader, record.metadata["header"].encode(), former_names=FORMER_NAMES
            )
        elif isinstance(record, Metadata) and record.name == FACTS:
            motion.facts = dict(record.metadata)
        elif isinstance(record, Channel) and record.topic in TOPICS:
            ours[record.id] = record.topic
        elif isinstance(record, Message) and record.channel_id in ours:
            yield ours[record.channel_id], record
