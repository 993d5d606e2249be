import math
import struct

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from teachpath_client.devices.fastrak_wire import (
    ASCII_SIZE,
    BINARY,
    STATUS_SIZE,
    AsciiParser,
    BinaryParser,
    Pose,
    read_status,
    write_record,
    write_status,
)
from tests.unit.clients.devices.readings import pose

POSES = [pose(i, 1 + i % 4) for i in range(200)]
FORMATS = pytest.mark.parametrize("binary", [True, False], ids=["binary", "ascii"])


def parser(binary: bool) -> BinaryParser | AsciiParser:
    return BinaryParser() if binary else AsciiParser()


def found(binary: bool, wire: bytes, size: int = 10**6) -> list[Pose]:
    """Return the records in bytes that come in pieces of `size`."""
    reader = parser(binary)
    return [pose for i in range(0, len(wire), size) for pose, _ in reader.feed(wire[i : i + size])]


def same(one: Pose, other: Pose) -> bool:
    near = [*one.position, *one.orientation] == pytest.approx([*other.position, *other.orientation], abs=1e-6)
    return (one.station, one.error) == (other.station, other.error) and near


def test_a_record_has_the_bytes_of_the_manual() -> None:
    example = Pose(2, " ", (1.5, -20.25, 300.0), (0.5, -0.5, 0.5, 0.5))
    binary = write_record(example, binary=True)
    assert binary == b"02 " + struct.pack("<fffffff", 1.5, -20.25, 300.0, 0.5, -0.5, 0.5, 0.5) + b"\r\n"
    assert len(binary) == BINARY.size == 33
    ascii_ = write_record(example, binary=False)
    assert ascii_ == b"02    1.50 -20.25 300.00 0.5000-0.5000 0.5000 0.5000\r\n"
    assert len(ascii_) == ASCII_SIZE == 54


def test_ascii_fields_may_be_padded_with_zeros() -> None:
    (one,) = found(False, b"01 +001.50-020.25 300.00 0.5000-0.5000+0.5000 0.5000\r\n")
    assert one.position == (1.5, -20.25, 300.0)
    assert one.orientation == (0.5, -0.5, 0.5, 0.5)


@FORMATS
@pytest.mark.parametrize("size", [1, 7, 33, 54, 100, 10**6])
def test_whole_records_come_out_in_order_whatever_the_pieces(binary: bool, size: int) -> None:
    wire = b"".join(write_record(p, binary=binary) for p in POSES)
    again = found(binary, wire, size)
    assert len(again) == len(POSES)
    assert all(map(same, again, POSES))


@FORMATS
@settings(max_examples=60, deadline=None)
@given(first=st.binary(max_size=80), count=st.integers(1, 4))
def test_the_bytes_behind_a_record_are_counted(binary: bool, first: bytes, count: int) -> None:
    reader = parser(binary)
    reader.feed(first)
    records = [write_record(p, binary=binary) for p in POSES[:count]]
    after = [b for _, b in reader.feed(b"".join(records))]
    size = len(records[0])
    assert after[-1] == 0
    assert after == [size * (len(after) - 1 - i) for i in range(len(after))]


@FORMATS
@settings(max_examples=300, deadline=None)
@given(wire=st.binary(max_size=400), size=st.integers(1, 100))
def test_no_bytes_raise_and_what_comes_out_is_a_pose(binary: bool, wire: bytes, size: int) -> None:
    for one in found(binary, wire, size):
        assert 1 <= one.station <= 4
        assert math.hypot(*one.orientation) == pytest.approx(1.0, abs=1e-9)
        assert all(map(math.isfinite, one.position))


@FORMATS
@settings(max_examples=300, deadline=None)
@given(noise=st.binary(max_size=200), size=st.integers(1, 100))
def test_after_noise_every_whole_record_comes_out_but_at_most_the_first(binary: bool, noise: bytes, size: int) -> None:
    wire = noise + b"".join(write_record(p, binary=binary) for p in POSES[:6])
    again = found(binary, wire, size)
    assert len(again) >= 5
    assert all(map(same, again[-5:], POSES[1:6]))


@FORMATS
@settings(max_examples=300, deadline=None)
@given(cuts=st.lists(st.tuples(st.integers(0, 53), st.integers(0, 53)), min_size=1, max_size=6))
def test_torn_records_spoil_no_whole_one(binary: bool, cuts: list[tuple[int, int]]) -> None:
    wire, whole = b"", []
    for i, (start, end) in enumerate(cuts):
        wire += write_record(POSES[2 * i], binary=binary)[start : start + min(end, 32)]
        wire += write_record(POSES[2 * i + 1], binary=binary)
        whole.append(POSES[2 * i + 1])
    again = found(binary, wire)
    for one in whole:
        assert any(same(one, other) for other in again)
    assert len(again) <= 2 * len(cuts)


def test_a_status_record_says_format_and_unit() -> None:
    for binary in (True, False):
        for centimetres in (True, False):
            record = write_status(1, binary=binary, centimetres=centimetres, continuous=False)
            assert len(record) == STATUS_SIZE
            assert read_status(b"noise 2" + record) == (binary, centimetres)
            assert read_status(record[:-1]) is None
    assert write_status(1, binary=True, centimetres=True, continuous=True).startswith(b"21S3FB")


@settings(max_examples=200, deadline=None)
@given(wire=st.binary(max_size=200))
def test_a_status_is_read_from_any_bytes(wire: bytes) -> None:
    assert read_status(wire) in (None, (False, False), (False, True), (True, False), (True, True))
