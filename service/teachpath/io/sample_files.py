"""Every sample of a demonstration as a CSV file, and back without a loss.

The first line is a comment that states the demonstration (tracker, calibration, verdict, account) as JSON; then comes
a header, and a row a sample in the order received. Numbers are written so that they are read to the last bit.
"""

from __future__ import annotations

import csv
import io

from teachpath.errors import UnusableInput, UnusableRecording, UnusableSample
from teachpath.io.documents import decode_demonstration, encode
from teachpath.io.import_settings import ImportSettings
from teachpath.io.readers.arrays import check_count
from teachpath.io.readers.text import text_lines
from teachpath.io.wire import decode_sample, encode_sample
from teachpath.records import Demonstration, Sample

MARK = "# teachpath "
COLUMNS = ["sequence", "device_ns", "receive_ns", "x", "y", "z", "qw", "qx", "qy", "qz", "tracked", "buttons"]
SENSORS = {f"f{number}": number for number in range(1, 23)}  # flexions by the names of their columns
JOINTS = {f"j{number}": number for number in range(1, 8)}  # likewise, joints of an arm that showed the task [rad]
LARGEST_NS = 2**63 - 1


def holds_samples(content: bytes) -> bool:
    """Tell whether a CSV file is one of samples."""
    return content.startswith(MARK.encode())


def write_samples(stated: Demonstration, samples: list[Sample]) -> bytes:
    """Return the file of a demonstration."""
    sensors = max((len(s.flexions) for s in samples), default=0)
    joints = max((len(s.joints) for s in samples), default=0)
    text = io.StringIO()
    text.write(f"{MARK}{encode(stated).decode()}\n")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([*COLUMNS, *list(SENSORS)[:sensors], *list(JOINTS)[:joints]])
    for s in samples:
        turn = map(repr, s.orientation) if s.orientation else ("",) * 4
        row = [s.sequence, s.device_ns, s.receive_ns, *map(repr, s.position), *turn, int(s.tracked), s.buttons]
        writer.writerow([*row, *_cells(s.flexions, sensors), *_cells(s.joints, joints)])
    return text.getvalue().encode()


def read_samples(content: bytes, name: str, limits: ImportSettings) -> tuple[Demonstration, list[Sample]]:
    """Return the demonstration that a file states, and its samples.

    Raises:
        UnusableRecording: the file is no such one, torn, or over the limits; names the line.
    """
    lines = text_lines(content, name, limits)
    try:
        stated = decode_demonstration(next(lines).removeprefix(MARK).encode())
        rows = csv.reader(lines)
        header = next(rows, [])
        sensors, joints = (sum(column in known for column in header) for known in (SENSORS, JOINTS))
        if header != [*COLUMNS, *list(SENSORS)[:sensors], *list(JOINTS)[:joints]]:
            columns = ",".join(COLUMNS)
            raise UnusableRecording(
                f"{name}, line 2: the columns must be {columns}, then flexions f1, f2, ..., then joints j1, j2, ..."
            )
        if not content.endswith(b"\n"):
            raise UnusableRecording(f"{name}: the last line does not end; is the file truncated?")
        shape = (len(header), len(COLUMNS) + sensors)
        read = [_sample(row, *shape, stated.source, f"{name}, line {i}") for i, row in enumerate(rows, 3) if row]
    except UnusableRecording:
        raise
    except (UnicodeDecodeError, csv.Error, ValueError, UnusableInput) as error:
        raise UnusableRecording(f"{name}: not the samples of a demonstration: {error}") from None
    if len(read) != stated.samples:
        raise UnusableRecording(f"{name}: {len(read)} samples, {stated.samples} stated in the first line")
    check_count(name, 1, len(read), limits)
    return stated, read


def _cells(values: tuple[float, ...], count: int) -> list[str]:
    return [repr(value) for value in values] + [""] * (count - len(values))


def _sample(row: list[str], count: int, joints_at: int, tracker: str, where: str) -> Sample:
    if len(row) != count:
        raise UnusableRecording(f"{where}: {len(row)} values, the header has {count} columns; is the file truncated?")
    try:
        sequence, device_ns, receive_ns = map(int, row[:3])
        x, y, z = map(float, row[3:6])
        turn = [float(cell) for cell in row[6:10] if cell]
        if len(turn) not in (0, 4) or row[10] not in ("0", "1") or not 0 <= receive_ns <= LARGEST_NS:
            raise ValueError(f"{','.join(row[2:11])} is no receive time, place, quaternion (or none) and 0 or 1")
        orientation = (turn[0], turn[1], turn[2], turn[3]) if turn else None
        flexions = tuple(float(cell) for cell in row[len(COLUMNS) : joints_at] if cell)
        joints = tuple(float(cell) for cell in row[joints_at:] if cell)
        stated = Sample(
            tracker,
            sequence,
            device_ns,
            receive_ns,
            (x, y, z),
            orientation,
            flexions,
            row[10] == "1",
            int(row[11]),
            joints,
        )
        sample = decode_sample(tracker, encode_sample(stated), receive_ns)
    except (ValueError, UnusableSample) as error:
        raise UnusableRecording(f"{where}: {error}") from None
    # It was of unit length when it was written; to make it so again would change its last bit.
    return sample._replace(orientation=orientation)
