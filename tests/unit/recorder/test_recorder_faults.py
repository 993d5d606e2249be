"""A disk that is full, read-only or away: a clear state, earlier takes untouched, and the next take is tried again."""

import errno
import io
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO

import pytest

from teachpath.io.store.recordings import open_new
from teachpath.io.store.salvage import salvage
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from tests.unit.recorder.recorders import Bench
from tests.unit.recording.hands import demonstration

SAMPLE_COUNT = 110


class Disk:
    """Opens files on a disk with `room` bytes left, or that refuses with `fault`."""

    def __init__(self) -> None:
        self.room = 10**9
        self.fault = 0

    def open(self, file: Path) -> BinaryIO:
        if self.fault:
            raise OSError(self.fault, os.strerror(self.fault), str(file))
        open_new(file).close()
        return io.BufferedWriter(_File(file, self))


class _File(io.FileIO):
    def __init__(self, file: Path, disk: Disk) -> None:
        super().__init__(file, "wb")
        self._disk = disk

    def write(self, content: Any) -> int:
        if len(content) > self._disk.room:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        self._disk.room -= len(content)
        return super().write(content)


@pytest.fixture
def disk() -> Disk:
    return Disk()


@pytest.fixture
def bench(disk: Disk, tmp_path: Path) -> Iterator[Bench]:
    store = Store(StoreSettings(data_dir=str(tmp_path / "data")), opener=disk.open)
    bench = Bench(store)
    yield bench
    bench.recorder.stop()
    store.close()


def kept(bench: Bench) -> dict[str, bytes]:
    return {f.name: f.read_bytes() for f in bench.store.recordings.folder("lift").glob("*.mcap")}


def shown(take: int) -> list[Any]:
    return demonstration(1 + (take - 1) * SAMPLE_COUNT)


def show(bench: Bench, take: int) -> None:
    bench.send(shown(take))
    bench.received(take * SAMPLE_COUNT)


@pytest.mark.parametrize("room", [0, 100, 2_000, 5_000])
def test_a_disk_that_is_full_is_said_and_harms_no_earlier_take(bench: Bench, disk: Disk, room: int) -> None:
    bench.begin()
    show(bench, 1)
    before = kept(bench)
    disk.room = room
    show(bench, 2)
    (row,) = bench.store.demonstrations("lift")
    report = bench.until(lambda report: True)
    assert (report.lost, len(report.demonstrations)) == (0, 1)
    assert any("No space left on device; free space" in note for note in report.notes)
    assert kept(bench) == before
    assert len(bench.store.recordings.samples(row.recording)) == row.samples

    disk.room = 10**9
    bench.now = 5.0  # the next flush tries again
    bench.until(lambda _: not bench.recorder.faults())
    show(bench, 3)
    assert [d.verdict for d in bench.store.demonstrations("lift")] == ["clean", "clean"]
    assert bench.end(3 * SAMPLE_COUNT).received == 3 * SAMPLE_COUNT


def test_what_was_written_before_the_disk_was_full_is_left_for_the_doctor(bench: Bench, disk: Disk) -> None:
    bench.begin()
    bench.send(shown(1)[:50])
    bench.received(50)
    bench.now = 2.0  # a flush is due
    bench.send(shown(1)[50:52])
    bench.received(52)
    disk.room = 0
    bench.send(shown(1)[52:])
    bench.end(SAMPLE_COUNT)
    (torn,) = bench.store.recordings.unfinished()
    header, samples, _ = salvage(torn)
    assert header is not None
    assert 50 <= len(samples) <= 52


def test_while_nothing_can_be_written_the_station_says_so(bench: Bench, disk: Disk) -> None:
    bench.begin()
    disk.fault = errno.EROFS
    bench.send(shown(1)[:40])
    bench.received(40)
    (fault,) = bench.recorder.faults()
    assert fault.startswith("glove: the recording cannot be written: Read-only file system; free space or mend")
    disk.fault = 0
    bench.send(shown(1)[40:])
    bench.received(SAMPLE_COUNT)
    assert bench.recorder.faults() == []
    assert any("a demonstration was lost" in note for note in bench.until(lambda report: True).notes)
    assert any("of lift by glove was not kept: its file could not" in said for said in bench.store.health.faults())
    show(bench, 2)
    assert len(bench.end(2 * SAMPLE_COUNT).demonstrations) == 1


def test_a_take_of_another_tracker_is_untouched_by_one_that_fails(bench: Bench, disk: Disk) -> None:
    bench.begin("left", "a")
    bench.begin("right", "b")
    bench.send(shown(1)[:30], "left")
    bench.received(30, "left")
    disk.fault = errno.EACCES
    bench.send(shown(1), "right")
    bench.received(SAMPLE_COUNT, "right")
    bench.send(shown(1)[30:], "left")
    assert bench.end(SAMPLE_COUNT, "right").demonstrations == []
    assert len(bench.end(SAMPLE_COUNT, "left").demonstrations) == 1
    assert [d.verdict for d in bench.store.demonstrations("a")] == ["clean"]


def test_a_viewer_that_fails_does_not_end_the_recorder(store: Store) -> None:
    def fail(*_: object) -> None:
        raise RuntimeError("the view is gone")

    bench = Bench(store, recorded=fail)
    try:
        bench.begin()
        bench.send(shown(1) + shown(2))
        assert len(bench.end(2 * SAMPLE_COUNT).demonstrations) == 2
    finally:
        bench.recorder.stop()
