"""What a recording's file is, by itself: what it holds, what it says of itself, and whether that is so."""

from __future__ import annotations

import io
from dataclasses import dataclass
from functools import cached_property
from hashlib import sha256
from pathlib import Path

from teachpath.errors import TeachpathError
from teachpath.io.documents import decode_demonstration
from teachpath.io.store.integrity import find_contradiction, with_new_summary
from teachpath.io.store.recording_facts import read_facts_stream
from teachpath.io.store.salvage import RecordingHeader, salvage_stream
from teachpath.records import Demonstration, RecordingDigest, Sample


@dataclass(frozen=True)
class Inspection:
    """A recording's file as it was read.

    Attributes:
        file: its path.
        header: what it is of; None where that cannot be read.
        samples: that can be read, in the order they were received.
        digest: of the file as it is.
        fault: what ended the reading, or in which way it contradicts itself; empty when it is whole.
        stated: its demonstration as it says; None where it says none.
    """

    file: Path
    header: RecordingHeader | None
    samples: tuple[Sample, ...]
    digest: RecordingDigest
    fault: str
    stated: Demonstration | None

    @property
    def is_whole(self) -> bool:
        """Whether it is a recording that can be read to its end and does not contradict itself."""
        return self.header is not None and not self.fault

    @property
    def seconds(self) -> float:
        """From the first sample to the last, by the device's clock."""
        return (self.samples[-1].device_ns - self.samples[0].device_ns) * 1e-9 if self.samples else 0.0

    @cached_property
    def with_new_summary(self) -> bytes | None:
        """Its content with its summary written anew, if only that is damaged; else None."""
        return with_new_summary(self.file.read_bytes()) if self.fault else None


def inspect(file: Path) -> Inspection:
    """Read a recording, torn or whole; raises OSError when it may not be read."""
    content = file.read_bytes()
    header, samples, fault = salvage_stream(io.BytesIO(content))
    numbers = [sample.sequence for sample in samples]
    if header is not None and not fault:
        fault = find_contradiction(content, numbers)
    elif header is None:
        fault = fault or "it does not say what it is of"
    digest = RecordingDigest(
        sha256(content).hexdigest(), len(content), len(numbers), min(numbers, default=0), max(numbers, default=0)
    )
    return Inspection(file, header, tuple(samples), digest, fault, _stated(content))


def _stated(content: bytes) -> Demonstration | None:
    text = read_facts_stream(io.BytesIO(content)).get("demonstration", "")
    try:
        return decode_demonstration(text.encode()) if text else None
    except TeachpathError:
        return None
