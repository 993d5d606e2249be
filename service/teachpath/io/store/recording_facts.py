"""What a recording says of its demonstration: written when it is finished, and amended when it is exported."""

from __future__ import annotations

import io
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import BinaryIO

from mcap.records import Metadata

from teachpath.io import documents
from teachpath.io.store.integrity import add_integrity
from teachpath.io.store.mcap_file import McapFile
from teachpath.io.store.mcap_records import read_records
from teachpath.io.store.recordings import FACTS
from teachpath.io.store.salvage import salvage_columns
from teachpath.records import Demonstration


def facts_of(demonstration: Demonstration) -> dict[str, str]:
    """Return what the recording of a demonstration says of itself."""
    stated = replace(
        demonstration, number=0, recording="", digest=None, station=""
    )  # which follow from where it is stored
    account = documents.encode(stated.statistics).decode()
    return {"verdict": stated.verdict, "statistics": account, "demonstration": documents.encode(stated).decode()}


def amended(content: bytes, demonstration: Demonstration) -> bytes:
    """Return a finished recording that says what has become of its demonstration since: marks, trim, verdict.

    Nothing that is in it is changed; what it says of itself last counts, its digest of all before too.

    Raises:
        UnusableRecording: the recording is damaged.
    """
    facts = facts_of(demonstration)
    if read_facts_stream(io.BytesIO(content)) == facts:
        return content
    stream = io.BytesIO()
    file = McapFile.reopen(stream, content)
    file.add_metadata(FACTS, facts)
    numbers = salvage_columns(io.BytesIO(content))[1].sequence.tolist()
    add_integrity(file, len(numbers), min(numbers, default=0), max(numbers, default=0))
    file.finish()
    return stream.getvalue()


def read_facts(file: Path) -> dict[str, str]:
    """Return what a recording said of itself when it was finished; nothing when it is torn before that."""
    with suppress(OSError), file.open("rb") as stream:
        return read_facts_stream(stream)
    return {}


def read_facts_stream(stream: BinaryIO) -> dict[str, str]:
    """Return what a recording says of itself, last of all, from an open file; as `read_facts`."""
    facts: dict[str, str] = {}
    with suppress(Exception):  # damage shows as whatever the reader raises
        for record in read_records(stream):
            if isinstance(record, Metadata) and record.name == FACTS:
                facts = dict(record.metadata)
    return facts
