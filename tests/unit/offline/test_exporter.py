"""Exports for download: a process of their own writes them, within limits, and outlives none of its faults."""

import asyncio
import zipfile
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from teachpath.errors import NotFound, OverLimit, QueueFull
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.jobs.settings import JobSettings
from teachpath.offline.exporter import Exporter, ExportSource
from teachpath.records import Demonstration
from tests.unit.offline.takes import EMPTY_SCENE, SETTINGS, TAKES, record

Open = Callable[..., Exporter]
DEFAULTS = JobSettings()


@pytest.fixture
def rows(tmp_path: Path) -> list[Demonstration]:
    store = Store(StoreSettings(data_dir=str(tmp_path / "data")))
    made = [record(store, TAKES[name]()) for name in list(TAKES)[:2]]
    store.close()
    return made


@pytest.fixture
def open_exporter(tmp_path: Path) -> Iterator[Open]:
    opened: list[Exporter] = []

    def opener(settings: JobSettings = DEFAULTS) -> Exporter:
        source = ExportSource(StoreSettings(data_dir=str(tmp_path / "data")), SETTINGS, (EMPTY_SCENE,))
        opened.append(Exporter(source, settings))
        return opened[-1]

    yield opener
    for exporter in opened:
        exporter.stop()


def write(exporter: Exporter, rows: list[Demonstration], folder: Path, kind: str = "csv", submitter: str = "") -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    zipped = len(rows) > 1
    return asyncio.run(exporter.write(rows, kind, folder, zipped=zipped, submitter=submitter))


def test_one_is_a_file_and_several_are_a_zip_file(
    open_exporter: Open, rows: list[Demonstration], tmp_path: Path
) -> None:
    exporter = open_exporter()
    one = write(exporter, rows[:1], tmp_path / "one")
    several = write(exporter, rows, tmp_path / "several")
    with zipfile.ZipFile(several) as archive:
        assert archive.testzip() is None
        assert archive.read(one.name) == one.read_bytes()
        assert len(archive.namelist()) == len(rows)


def test_a_refusal_is_that_of_the_export_and_the_next_one_is_written(
    open_exporter: Open, rows: list[Demonstration], tmp_path: Path
) -> None:
    exporter = open_exporter()
    with pytest.raises(NotFound, match="is missing"):
        write(exporter, [replace(rows[0], recording="gone.mcap")], tmp_path / "one")
    assert write(exporter, rows[:1], tmp_path / "two").is_file()


def test_an_export_that_takes_too_long_is_ended(open_exporter: Open, rows: list[Demonstration], tmp_path: Path) -> None:
    with pytest.raises(OverLimit, match=r"the export takes over 0.001 s, the limit \(jobs.max_file_duration\)"):
        write(open_exporter(JobSettings(max_file_duration=0.001)), rows, tmp_path / "one")


def test_one_who_asks_for_many_leaves_room_for_others(
    open_exporter: Open, rows: list[Demonstration], tmp_path: Path
) -> None:
    exporter = open_exporter(JobSettings(max_exports=2))

    async def ask() -> list[object]:
        asked = []
        for number, submitter in enumerate(("ann", "ann", "bob", "cy")):
            (folder := tmp_path / str(number)).mkdir()
            asked.append(exporter.write(rows[:1], "csv", folder, zipped=False, submitter=submitter))
        return await asyncio.gather(*asked, return_exceptions=True)

    one, refused, other, full = asyncio.run(ask())
    assert isinstance(one, Path)
    assert isinstance(other, Path)
    for each, sentence in ((refused, "1 exports wait or run, 1 of them for ann"), (full, "2 exports wait or run")):
        assert isinstance(each, QueueFull)
        assert sentence in str(each)
    assert write(exporter, rows[:1], tmp_path / "after", submitter="ann").is_file()
