from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from teachpath.io.store.recordings import Recordings
from teachpath.io.store.salvage import RecordingHeader
from teachpath.io.wire import decode_sample
from teachpath.records import Calibration, Sample
from teachpath_client.errors import ClientError
from teachpath_client.reading import HandReading
from teachpath_client.replay import read_mcap
from teachpath_client.synthetic import experiment_1

START_NS = 1_700_000_000_000_000_000
READINGS = [next_ for next_, _ in zip(experiment_1(1), range(120), strict=False)]


def sample(reading: HandReading, sequence: int) -> Sample:
    payload = reading.message(sequence, START_NS).SerializeToString()
    return decode_sample("glove", payload, START_NS + sequence)


def recorded(folder: Path, samples: list[Sample]) -> bytes:
    """Write samples as the service does and return its file."""
    take = Recordings(folder).begin("d", RecordingHeader("t", "glove", Calibration("identity")))
    for s in samples:
        take.write(s)
    return take.finish({}).read_bytes()


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    return recorded(tmp_path_factory.mktemp("whole"), [sample(r, i) for i, r in enumerate(READINGS, 1)])


def same(again: list[HandReading], readings: list[HandReading]) -> None:
    start = readings[0].time
    assert [r.time for r in again] == pytest.approx([r.time - start for r in readings], abs=1e-9)
    assert [r.position for r in again] == [r.position for r in readings]
    assert [r.orientation for r in again] == [pytest.approx(r.orientation, abs=1e-15) for r in readings]
    assert [r.flexions for r in again] == [pytest.approx(r.flexions, abs=1e-7) for r in readings]


def test_a_recording_of_the_service_gives_the_same_readings(tmp_path: Path) -> None:
    samples = [sample(r, i) for i, r in enumerate(READINGS, 1)]
    same(read_mcap(recorded(tmp_path, samples)), READINGS)


def test_late_and_doubled_samples_come_in_their_order_and_once(tmp_path: Path) -> None:
    samples = [sample(r, i) for i, r in enumerate(READINGS, 1)]
    mixed = [*samples[:10], samples[11], samples[10], samples[10], *samples[12:]]
    same(read_mcap(recorded(tmp_path, mixed)), READINGS)


def test_what_was_not_measured_stays_unmeasured(tmp_path: Path) -> None:
    bare = [HandReading(i * 0.02, (0.1 * i, 0.0, 0.5), None, (), i != 1, i % 2) for i in range(4)]
    again = read_mcap(recorded(tmp_path, [sample(r, i) for i, r in enumerate(bare, 1)]))
    assert [(r.orientation, r.flexions, r.tracked, r.buttons) for r in again] == [
        (None, (), r.tracked, r.buttons) for r in bare
    ]


@pytest.mark.parametrize("content", [b"", b"rubbish", b"\x89MCAP0\r\n", bytes(1000)])
def test_what_is_no_recording_is_a_client_error(content: bytes) -> None:
    with pytest.raises(ClientError, match=r"not a recording of hand samples"):
        read_mcap(content)


def test_a_torn_or_empty_recording_is_a_client_error(whole: bytes, tmp_path: Path) -> None:
    for cut in range(0, len(whole) - 1, len(whole) // 40):
        with pytest.raises(ClientError):
            read_mcap(whole[:cut])
    with pytest.raises(ClientError, match="holds no hand samples"):
        read_mcap(recorded(tmp_path / "empty", []))


@settings(max_examples=150, deadline=None)
@given(place=st.integers(0, 10**6), value=st.integers(0, 255))
def test_a_damaged_recording_is_a_client_error_or_whole(whole: bytes, place: int, value: int) -> None:
    damaged = bytearray(whole)
    damaged[place % len(damaged)] = value
    try:
        again = read_mcap(bytes(damaged))
    except ClientError:
        return
    same(again, READINGS)
