"""Bags of ROS: every storage and every message of a pose gives the same motion; what is open is said."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from teachpath.errors import UnusableInput, UnusableRecording
from teachpath.io.import_settings import ImportSettings
from teachpath.io.readers.bags import is_bag
from teachpath.io.readers.contract import FileMotions, ReadOptions
from teachpath.io.readers.registry import read_motions, recognized
from teachpath.io.store.mcap_file import McapFile
from teachpath.offline.file_samples import Source, read_source
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Calibration
from tests.unit.io.readers import bags
from tests.unit.io.readers.bags import Messages, write_bag
from tests.unit.io.readers.test_damage import damaged
from tests.unit.io.readers.test_formats import NS, POSITIONS, TIMES, WXYZ, XYZW

KINDS = (bags.POSE, bags.COVARIANT, bags.TRANSFORM, bags.TRANSFORMS, bags.ODOMETRY)
LOG_TIME_NS = 7_000_000  # [ns] after which a message was recorded


def motion(storage: str, topic: str = "/hand", kind: str = bags.POSE, **named: str) -> list[tuple[str, str, int, Any]]:
    make = Messages(storage)
    frame = named.pop("frame", "base")
    return [
        (topic, kind, int(ns) + LOG_TIME_NS, make.make(kind, int(ns), p, q, frame, **named))
        for ns, p, q in zip(NS, POSITIONS, XYZW, strict=True)
    ]


def read(content: bytes, name: str = "f.mcap", limits: ImportSettings | None = None, **options: str) -> FileMotions:
    return read_motions(content, name, "", ReadOptions(**options), limits or ImportSettings())  # type: ignore[arg-type]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("storage", bags.STORAGES)
def test_every_storage_and_message_gives_the_same_motion(tmp_path: Path, storage: str, kind: str) -> None:
    others = [("/chatter", bags.TEXT, int(NS[0]), Messages(storage).text("moon"))]
    content = write_bag(tmp_path, storage, [*others, *motion(storage, kind=kind)])
    assert recognized(content, "anything") == "rosbag"
    found = read(content, f"f.{storage}")
    (track,) = found.tracks
    assert np.array_equal(track.stamps_ns, NS)
    assert np.array_equal(track.positions, POSITIONS)
    assert track.orientations is not None
    assert np.allclose(track.orientations, WXYZ, atol=1e-15)
    told = "; ".join(found.understood)
    assert ("hand" in told, "time from the headers" in told, "frame base" in told) == (True, True, True)


@pytest.mark.parametrize("storage", bags.STORAGES)
def test_one_topic_and_one_frame_of_several_is_chosen(tmp_path: Path, storage: str) -> None:
    messages = motion(storage) + motion(storage, "/tf", bags.TRANSFORMS, child="elbow")
    content = write_bag(tmp_path, storage, sorted(messages, key=lambda each: each[2]))
    with pytest.raises(UnusableRecording, match=r"it holds 2 of them; choose one with --track /hand or elbow"):
        read(content)
    with pytest.raises(UnusableRecording, match=r"no 'knee' in it; choose one with --track /hand or elbow"):
        read(content, track="knee")
    assert all(len(read(content, track=each).tracks[0].stamps_ns) == len(NS) for each in ("/hand", "elbow"))
    assert read(content, track="elbow").choices == ("/hand", "elbow")


def test_without_stamps_the_time_of_the_recording_counts(tmp_path: Path) -> None:
    make = Messages("mcap")
    unstamped = [
        ("/hand", bags.POSE, int(ns), make.make(bags.POSE, 0, p, q, "base"))
        for ns, p, q in zip(NS, POSITIONS, XYZW, strict=True)
    ]
    found = read(write_bag(tmp_path, "mcap", unstamped))
    assert np.allclose(found.tracks[0].times, TIMES, atol=1e-9)
    assert "time as recorded: the headers have none" in found.understood
    (tmp_path / "mixed").mkdir()
    mixed = write_bag(tmp_path / "mixed", "mcap", [*unstamped[:20], *motion("mcap")[20:]])
    with pytest.raises(UnusableRecording, match="only some messages of /hand have a stamp"):
        read(mixed)


def test_two_frames_no_poses_and_too_many_are_said(tmp_path: Path) -> None:
    for number, (messages, limits, sentence) in enumerate(
        [
            (motion("mcap")[:20] + motion("mcap", frame="map")[20:], ImportSettings(), r"the frame base and in map"),
            ([("/chatter", bags.TEXT, 1, Messages("mcap").text("moon"))], ImportSettings(), r"holds std_msgs/String"),
            (motion("mcap") * 3, ImportSettings(max_samples=100), r"over 100 poses, the limit \(imports\.max_samples"),
        ]
    ):
        folder = tmp_path / str(number)
        folder.mkdir()
        with pytest.raises(UnusableRecording, match=sentence):
            read(write_bag(folder, "mcap", messages), limits=limits)


@pytest.mark.parametrize("name", ["hand.mcap", "hand"])
def test_a_bag_of_ros_is_no_recording_of_ours(tmp_path: Path, name: str) -> None:
    source = Source(name, write_bag(tmp_path, "mcap", motion("mcap")))
    found = read_source(source, Calibration("identity"), ImportSettings(), RecordingSettings())
    assert (found.format, len(found.motions[0])) == ("rosbag", len(NS))


def test_a_recording_of_ours_is_no_bag(tmp_path: Path) -> None:
    file = tmp_path / "ours.mcap"
    with file.open("wb") as stream:
        McapFile(stream).finish()
    assert not is_bag(file.read_bytes())
    assert not is_bag(file.read_bytes()[:9])


@pytest.mark.parametrize("storage", bags.STORAGES)
def test_a_damaged_bag_ends_in_a_sentence_or_in_a_motion(tmp_path: Path, storage: str) -> None:
    content = write_bag(tmp_path, storage, motion(storage))
    said = []
    for number in range(60):
        random = np.random.default_rng([number, bags.STORAGES.index(storage)])
        try:
            found = read_motions(damaged(content, random), "f.bag", "rosbag", ReadOptions(), ImportSettings())
            assert all(np.isfinite(track.positions[track.tracked or slice(None)]).all() for track in found.tracks)
        except UnusableInput as error:
            said.append(str(error))
    assert all(sentence.startswith("f.bag") for sentence in said)
