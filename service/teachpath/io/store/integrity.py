"""What a recording's file says of its own content, and whether that is true.

The last record before the summary states how much comes before it, its SHA-256, and the samples in it; the summary has
a check sum. So a file that is alone, without the row that knows the SHA-256 of the whole, tells of every flipped bit.
"""

from __future__ import annotations

import io
import struct
import zlib
from hashlib import sha256
from typing import Final

from mcap.exceptions import EndOfFile
from mcap.records import Metadata, MetadataIndex

from teachpath.io.store.mcap_file import DATA_END, FOOTER, MAGIC, McapFile
from teachpath.io.store.mcap_records import read_records

INTEGRITY: Final = "integrity"  # name of the metadata
_RECORD_HEAD: Final = struct.Struct("<BQ")  # opcode, length


def add_integrity(file: McapFile, samples: int, first: int, last: int) -> None:
    """Let a file state its content up to here: SHA-256, size, and of its samples count, lowest and highest number."""
    stated = {"sha256": file.sha256, "size": file.size, "samples": samples, "first": first, "last": last}
    file.add_metadata(INTEGRITY, {name: str(value) for name, value in stated.items()})


def stated_integrity(content: bytes) -> dict[str, str]:
    """Return what a file states of its content, last of all; nothing where it states nothing, or is damaged before."""
    stated: dict[str, str] = {}
    try:
        for record in read_records(io.BytesIO(content)):
            if isinstance(record, Metadata) and record.name == INTEGRITY:
                stated = record.metadata
    except Exception:  # damage shows as whatever the reader raises
        return stated
    return stated


def find_contradiction(content: bytes, numbers: list[int]) -> str:
    """Return in which way a file that can be read contradicts itself, or nothing.

    Args:
        content: of the file.
        numbers: of its samples, in the order they came.
    """
    stated = stated_integrity(content)
    if stated:
        found = {
            "sha256": sha256(content[: _size(stated)]).hexdigest(),
            "size": stated.get("size"),
            "samples": str(len(numbers)),
            "first": str(min(numbers, default=0)),
            "last": str(max(numbers, default=0)),
        }
        for name, value in found.items():
            if stated.get(name) != value:
                return f"it states {name} {stated.get(name)}, and has {value}"
    if not _is_tail_whole(content, _end_of_data(content, stated)):
        return "the check sum of its summary is wrong"
    return "" if _metadata_match(content) else "its metadata are not those that its summary names"


def with_new_summary(content: bytes) -> bytes | None:
    """Return a recording whose summary is written anew, where all before it is as stated; None where it is not."""
    stated = stated_integrity(content)
    if not stated or sha256(content[: _size(stated)]).hexdigest() != stated.get("sha256"):
        return None
    end = _end_of_data(content, stated)
    stream = io.BytesIO()
    McapFile.reopen(stream, content[:end] + DATA_END).finish()
    return stream.getvalue()


def _size(stated: dict[str, str]) -> int:
    text = stated.get("size", "")
    return int(text) if text.isascii() and text.isdigit() else 0


def _end_of_data(content: bytes, stated: dict[str, str]) -> int | None:
    """Return where the record that states the content ends [bytes]; None: there is none."""
    size = _size(stated)
    if not size or size + _RECORD_HEAD.size > len(content):
        return None
    _, length = _RECORD_HEAD.unpack_from(content, size)
    return size + _RECORD_HEAD.size + int(length)


def _is_tail_whole(content: bytes, end: int | None) -> bool:
    tail = FOOTER.size + len(MAGIC)
    if len(content) < tail or not content.endswith(MAGIC):
        return False
    _, _, start, _, stated = FOOTER.unpack_from(content, len(content) - tail)
    if end is not None and content[end:start] != DATA_END:
        return False
    return bool(stated == 0 or zlib.crc32(content[start : len(content) - len(MAGIC) - 4]) == stated)


def _metadata_match(content: bytes) -> bool:
    written, named = [], []
    try:
        for record in read_records(io.BytesIO(content)):
            if isinstance(record, Metadata):
                written.append(record.name)
            elif isinstance(record, MetadataIndex):
                named.append(record.name)
    except EndOfFile:
        return False
    return written == named
