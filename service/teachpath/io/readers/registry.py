"""All readers, those of the house and those of other packages, and the checks that what they read must pass."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import replace
from importlib.metadata import entry_points
from pathlib import Path

from teachpath.errors import UnusableInput, UnusableRecording
from teachpath.io.import_settings import ImportSettings
from teachpath.io.readers.arrays import MATRICES, NPY, NPZ, ROBOTTASKS, check_count
from teachpath.io.readers.bags import ROSBAG
from teachpath.io.readers.c3d import C3D
from teachpath.io.readers.checks import checked
from teachpath.io.readers.columns import parse_columns
from teachpath.io.readers.contract import (
    QUATERNION_ORDERS,
    TIME_UNITS,
    UNITS,
    FileMotions,
    Progress,
    Reader,
    ReadOptions,
    unheard,
)
from teachpath.io.readers.hdf5 import HDF5
from teachpath.io.readers.joints import ToolKinematics, with_tool_motions
from teachpath.io.readers.lerobot import LEROBOT
from teachpath.io.readers.matlab import MATLAB
from teachpath.io.readers.motion_capture import MOTIVE, TRC, VICON
from teachpath.io.readers.tables import ARKIT, EUROC, TABLE, TUM

GROUP = "teachpath.readers"
LARGEST_FILE = 64 * 1024 * 1024  # bytes
BUILT_IN_READERS = (
    MOTIVE,
    VICON,
    TRC,
    C3D,
    EUROC,
    TUM,
    ARKIT,
    MATRICES,
    MATLAB,
    HDF5,
    NPZ,
    NPY,
    ROBOTTASKS,
    ROSBAG,
    LEROBOT,
    TABLE,
)


@functools.cache
def readers() -> Mapping[str, Reader]:
    """Return all readers by their names; what another package calls like one of the house is left out."""
    known = {reader.name: reader for reader in BUILT_IN_READERS}
    for entry in entry_points(group=GROUP):
        if entry.name in known:
            continue
        try:
            reader = entry.load()
        except Exception as error:  # of another package: whatever it raises
            raise UnusableInput(
                f"the reader {entry.name} cannot be loaded: {error}; remove its package or mend it"
            ) from None
        if not isinstance(reader, Reader):
            raise UnusableInput(
                f"the reader {entry.name} ({entry.value}) is no Reader of teachpath.io.readers.contract"
            )
        known[entry.name] = reader
    return known


def recognized(content: bytes, name: str) -> str:
    """Return the name of the format that a file certainly has; `csv` if it is none of those that can be told."""
    return next((reader.name for reader in readers().values() if reader.recognizes(content, name.lower())), TABLE.name)


def reads_from_disk(kind: str, beginning: bytes, name: str) -> bool:
    """Tell whether files of a format are read where they lie; `kind` may be empty, or mcap, or unknown."""
    reader = readers().get(kind or recognized(beginning, name))
    return reader is not None and reader.read_file is not None


def check_options(name: str, kind: str, options: ReadOptions) -> None:
    """Raise UnusableRecording when a file `name` cannot be read as asked for; `kind` may also be mcap or empty."""
    known = [*readers(), "mcap"]
    if kind and kind not in known:
        raise UnusableRecording(f"{name}: format {kind!r} is unknown; known: {', '.join(known)}")
    choices = (
        ("units {} are", options.units, UNITS),
        ("a time unit {} is", options.time_unit, TIME_UNITS),
        ("a quaternion order {} is", options.quaternion, QUATERNION_ORDERS),
    )
    for what, value, allowed in choices:
        if value and value not in allowed:
            raise UnusableRecording(f"{name}: {what.format(repr(value))} unknown; known: {', '.join(allowed)}")
    if options.rate and not 1.0 <= options.rate <= 10_000.0:
        raise UnusableRecording(f"{name}: a rate of {options.rate:g} Hz is outside 1 to 10000")
    parse_columns(options.columns)


def read_motions(
    content: bytes,
    name: str,
    kind: str,
    options: ReadOptions,
    limits: ImportSettings,
    arm: ToolKinematics | None = None,
    *,
    file: Path | None = None,
    progress: Progress = unheard,
) -> FileMotions:
    """Read the motions of a file and check them.

    Args:
        content: of the file; its beginning is enough where `reads_from_disk` and the file is given.
        name: of the file, for errors.
        kind: name of its format; empty: that which it has.
        options: what the user says of it.
        limits: of what it may hold.
        arm: whose joint angles it may hold; None: no arm is known.
        file: where it lies, of any size.
        progress: told the share that was read, of a file that lies somewhere.

    Raises:
        UnusableRecording: with the row or sample that is wrong, and the way out.
    """
    check_options(name, kind, options)
    if len(content) > LARGEST_FILE:
        raise UnusableRecording(f"{name}: {len(content)} bytes are over the limit of {LARGEST_FILE}; split the file")
    if not content:
        raise UnusableRecording(f"{name}: the file is empty")
    reader = readers()[kind or recognized(content, name)]
    options = replace(options, joints=() if arm is None else arm.joints)
    try:
        if file is not None and reader.read_file is not None:
            found = reader.read_file(file, name, options, limits, progress)
        else:
            found = reader.read(content, name, options, limits)
    except (UnusableInput, MemoryError):
        raise
    except Exception as error:  # damage shows as whatever a reader, a decompressor or an unpacking raises
        raise UnusableRecording(f"{name}: not a whole file of format {reader.name} ({reader.title}): {error}") from None
    found = with_tool_motions(found, arm, name)
    check_count(name, len(found.tracks), sum(len(track.positions) for track in found.tracks), limits)
    if not found.tracks:
        raise UnusableRecording(f"{name}: there are no motions in it")
    several = len(found.tracks) > 1
    tracks = [
        checked(track, f"{name}, motion {number}" if several else name, limits)
        for number, track in enumerate(found.tracks, 1)
    ]
    return replace(found, tracks=tracks, understood=(f"{reader.name}: {reader.title}", *found.understood))
