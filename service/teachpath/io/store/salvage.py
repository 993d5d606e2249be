"""Reading a recording, whole or torn: what it is of, and all its samples that are whole."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

import numpy as np
from mcap.exceptions import EndOfFile
from mcap.records import Channel, Message, Metadata, Statistics

from teachpath.errors import UnusableRecording, UnusableSample
from teachpath.io import documents
from teachpath.io.import_settings import ImportSettings
from teachpath.io.store.mcap_records import read_records
from teachpath.io.wire import SampleBatchDecoder, decode_sample
from teachpath.records import Calibration, ObjectPose, Sample, SampleColumns, Vector

TOPIC = "samples"
HEADER = "teachpath"  # name of the metadata that says what a recording is of


@dataclass(frozen=True, slots=True)
class RecordingHeader:
    """What a recording is of; the first record of its file, so that a torn file still says it."""

    task: str
    tracker: str
    calibration: Calibration
    scene: str = ""  # its name; empty in files of before it was said
    carried: Vector | None = None  # start of the object's centre [m, world]; None: the scene has none
    object_pose: ObjectPose | None = None  # where the object was told to lie then; None = where the scene has it
    object_at_grasp: bool = False  # the object lies where the hand grasps


def salvage(file: Path) -> tuple[RecordingHeader | None, list[Sample], str]:
    """Read a recording that may be torn: (header, the samples that are whole, what ended the reading or '')."""
    with file.open("rb") as stream:
        return salvage_stream(stream)


def salvage_stream(
    stream: BinaryIO, limits: ImportSettings | None = None
) -> tuple[RecordingHeader | None, list[Sample], str]:
    """Read a recording from an open file, as `salvage`; reading ends where `limits` are passed."""
    header, columns, fault = salvage_columns(stream, limits)
    return header, list(columns), fault


def salvage_columns(
    stream: BinaryIO, limits: ImportSettings | None = None
) -> tuple[RecordingHeader | None, SampleColumns, str]:
    """Read a recording from an open file, as `salvage_stream`."""
    header, payloads, receive_ns, fault = salvage_messages(stream, limits)
    columns, refused = _decoded(header.tracker if header else "", payloads, receive_ns)
    return header, columns, refused or fault


def salvage_messages(
    stream: BinaryIO, limits: ImportSettings | None = None
) -> tuple[RecordingHeader | None, list[bytes], list[int], str]:
    """Read a recording from an open file: (header, its samples as they came, when [ns], what ended the reading)."""
    header: RecordingHeader | None = None
    payloads: list[bytes] = []
    receive_ns: list[int] = []
    fault = ""
    ours: set[int] = set()  # channels that hold samples
    try:
        for record in read_records(stream, limits):
            if isinstance(record, Message):  # first: nearly all are
                if record.channel_id not in ours:
                    continue
                if limits is not None and len(payloads) == limits.max_samples:
                    raise UnusableRecording(
                        f"it has over {len(payloads)} samples, the limit (imports.max_samples); split the recording"
                    )
                payloads.append(record.data)
                receive_ns.append(record.log_time)
            elif isinstance(record, Metadata) and record.name == HEADER:
                header = documents.decode(RecordingHeader, record.metadata["header"].encode())
            elif isinstance(record, Channel) and record.topic == TOPIC:
                ours.add(record.id)
            elif isinstance(record, Statistics):
                # A reader passes over a record of a kind that it does not know, so a damaged kind hides a whole chunk.
                written = sum(record.channel_message_counts.get(channel, 0) for channel in ours)
                if written != len(payloads):
                    fault = f"{len(payloads)} of its {written} samples can be read"
    except (OSError, MemoryError):
        raise
    except EndOfFile:
        fault = "it is cut off"
    except Exception as error:  # damage shows as whatever the reader, its decompressor or the unpacking raises
        fault = str(error) or type(error).__name__
    return header, payloads, receive_ns, fault


def _decoded(tracker: str, payloads: list[bytes], receive_ns: list[int]) -> tuple[SampleColumns, str]:
    """Return the samples up to the first that is refused, and why that is."""
    columns, usable = SampleBatchDecoder().decode(payloads, receive_ns, tracker)
    parts, begin = [], 0
    for at in np.flatnonzero(~usable).tolist():
        parts.append(columns[begin:at])
        try:
            parts.append(SampleColumns.of([decode_sample(tracker, payloads[at], receive_ns[at])]))
        except UnusableSample as error:
            return SampleColumns.joined(parts), str(error)
        begin = at + 1
    return SampleColumns.joined([*parts, columns[begin:]]), ""
