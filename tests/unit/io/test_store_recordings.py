from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from teachpath.errors import NotFound, UnusableRecording
from teachpath.io.store import RecordingHeader, Recordings, Take
from teachpath.io.store.recordings import salvage
from teachpath.records import Calibration, Sample
from tests.unit.recording.hands import demonstration

HEADER = RecordingHeader("lift", "glove", Calibration("lab", scale=0.5))
SAMPLES = demonstration()


def take(folder: Path, samples: list[Sample] = SAMPLES) -> tuple[Recordings, Take]:
    recordings = Recordings(folder)
    begun = recordings.begin("d", HEADER)
    for sample in samples:
        begun.write(sample)
    return recordings, begun


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return take(tmp_path_factory.mktemp("recordings"))[1].finish({"verdict": "clean"})


def same(again: list[Sample], samples: list[Sample]) -> bool:
    return [(s.sequence, s.device_ns, s.receive_ns, s.position, s.orientation, s.tracker) for s in again] == [
        (s.sequence, s.device_ns, s.receive_ns, s.position, s.orientation, s.tracker) for s in samples
    ]


def test_a_recording_gives_back_every_sample_as_it_came(tmp_path: Path) -> None:
    recordings, begun = take(tmp_path)
    assert [f.name for f in recordings.unfinished()] == ["d.mcap.part"]
    file = begun.finish({})
    assert recordings.unfinished() == []
    assert recordings.place(file) == "lift/d.mcap"
    assert same(recordings.samples("lift/d.mcap"), SAMPLES)
    assert salvage(file)[0] == HEADER


def test_what_was_flushed_is_there_before_the_end(tmp_path: Path) -> None:
    recordings, begun = take(tmp_path)
    begun.flush()
    header, samples, fault = salvage(recordings.unfinished()[0])
    assert header == HEADER
    assert same(samples, SAMPLES)
    assert fault
    begun.discard()
    assert recordings.unfinished() == []


@pytest.mark.parametrize("place", ["lift/moon.mcap", "", "..", "lift"])
def test_a_recording_that_is_not_there_is_named(tmp_path: Path, place: str) -> None:
    with pytest.raises(NotFound, match=r"is missing under .*; was the folder moved\?"):
        Recordings(tmp_path).path(place)


@settings(max_examples=150, deadline=None)
@given(cut=st.integers(0, 10**6))
def test_a_torn_recording_gives_its_first_samples_and_says_that_it_is_torn(whole: Path, cut: int) -> None:
    content = whole.read_bytes()
    torn = whole.with_name("torn.mcap")
    torn.write_bytes(content[: cut % (len(content) - 1)])
    header, samples, fault = salvage(torn)
    assert header in (None, HEADER)
    assert same(samples, SAMPLES[: len(samples)]) or header is None
    assert fault or len(samples) == len(SAMPLES)


@settings(max_examples=150, deadline=None)
@given(place=st.integers(0, 10**6), value=st.integers(0, 255))
def test_a_damaged_recording_gives_no_wrong_sample(whole: Path, place: int, value: int) -> None:
    content = bytearray(whole.read_bytes())
    content[place % len(content)] = value
    damaged = whole.with_name("damaged.mcap")
    damaged.write_bytes(content)
    header, samples, fault = salvage(damaged)
    if header == HEADER:
        assert same(samples, SAMPLES[: len(samples)])
    assert fault or len(samples) == len(SAMPLES)
    recordings = Recordings(whole.parents[1])
    if fault or header is None:
        with pytest.raises(UnusableRecording, match=r"lift/damaged\.mcap is damaged .*teachpath doctor"):
            recordings.samples("lift/damaged.mcap")
