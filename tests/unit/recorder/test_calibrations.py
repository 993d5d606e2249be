"""Calibrations that are measured again: every version lasts, and demonstrations are refused or converted."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from teachpath.errors import Conflict, NotFound, UnusableInput
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.recorder.annotations import Annotations
from teachpath.recorder.calibrations import Calibrations
from teachpath.recorder.recording_setup import RecordingSetup
from teachpath.recorder.session import RecordingSession
from teachpath.recording.advice import ending_advice
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Calibration, Demonstration, Scene, TaughtPoint, Vector, Verdict
from tests.unit.recording.hands import demonstration

IDENTITY, CALIBRATION_ARGUMENTS = Calibration("identity"), Scene("empty")
SQUARE = [(0.4, -0.3, 0.5), (0.7, -0.3, 0.5), (0.7, 0.3, 0.5)]


def scene(_name: str) -> Scene:
    return CALIBRATION_ARGUMENTS


def shifted(offset: Vector) -> list[TaughtPoint]:
    """Return points of a tracker whose frame lies at `offset`."""
    return [TaughtPoint(tuple(np.subtract(place, offset).tolist()), place) for place in SQUARE]


def calibrations(store: Store, *configured: Calibration) -> Calibrations:
    return Calibrations(store, RecordingSettings(), configured or (IDENTITY,), scene)


@pytest.fixture
def store(tmp_path: Path) -> Iterator[Store]:
    store = Store(StoreSettings(data_dir=str(tmp_path)))
    store.ensure_task("lift", scene="empty", calibration="lab")
    yield store
    store.close()


def recorded(store: Store, calibration: Calibration) -> Demonstration:
    session = RecordingSession(
        store, RecordingSettings(), RecordingSetup("lift", "glove", calibration, CALIBRATION_ARGUMENTS)
    )
    finished = [session.add(sample) for sample in demonstration()] + session.finish()
    ((row, _),) = [f for f in finished if f is not None]
    return row


def positions(store: Store, row: Demonstration) -> np.ndarray:
    return Annotations(store, RecordingSettings(), scene).trajectory(row).positions


def test_every_version_outlives_the_service_and_the_newest_counts(store: Store, tmp_path: Path) -> None:
    newest = calibrations(store)
    for x in (1.0, 2.0):
        made = newest.measure("lab", shifted((x, 0.0, 0.0)), source="fastrak")
    assert (made.version, made.source, made.calibration.offset[0]) == (2, "fastrak", pytest.approx(2.0))
    store.close()
    again = Store(StoreSettings(data_dir=str(tmp_path)))
    newest = calibrations(again)
    assert again.calibrations.versions("lab")[0] == made
    assert newest.get("lab") == made.calibration
    assert newest.get("lab@1").offset[0] == pytest.approx(1.0)
    assert [m.calibration.name for m in newest.newest()] == ["identity", "lab"]
    again.close()


def test_only_looking_keeps_nothing(store: Store) -> None:
    shown = calibrations(store).measure("lab", shifted((1.0, 0.0, 0.0)), keep=False)
    assert (shown.version, store.calibrations.versions("lab")) == (0, [])


def test_a_name_of_the_settings_or_no_name_is_refused(store: Store) -> None:
    newest = calibrations(store)
    with pytest.raises(Conflict, match="identity is in the settings"):
        newest.measure("identity", shifted((1.0, 0.0, 0.0)))
    for name in ("lab@1", "", "../lab"):
        with pytest.raises(UnusableInput, match="cannot name a calibration"):
            newest.measure(name, shifted((1.0, 0.0, 0.0)))
    newest.measure("lab", shifted((1.0, 0.0, 0.0)))
    with pytest.raises(Conflict, match="lab was measured here and is in the settings too"):
        calibrations(store, Calibration("lab"))
    for name, sentence in (("moon", "known: identity, lab"), ("lab@3", "no version 3"), ("lab@x", "write e.g. lab@1")):
        with pytest.raises(NotFound, match=sentence):
            newest.get(name)


def test_demonstrations_under_a_former_version_are_refused_until_they_are_converted(store: Store) -> None:
    newest = calibrations(store)
    before = recorded(store, newest.measure("lab", shifted((0.1, 0.0, 0.0))).calibration)
    newest.require_current([before])
    now = newest.measure("lab", shifted((0.3, 0.0, 0.0))).calibration
    after = recorded(store, now)
    with pytest.raises(
        Conflict, match=r"demonstrations 1 were .* teachpath recalibrate lift; .* learn --as-recorded lift"
    ):
        newest.require_current([before, after])

    (changed, same) = newest.convert([before, after])
    newest.require_current([changed, same])
    assert (changed.calibration, same) == (now, after)
    assert np.allclose(positions(store, changed) - positions(store, before), [0.2, 0.0, 0.0])
    assert store.demonstration(before.id) == changed
    assert newest.convert([changed], "lab@1") == [before]


def test_a_conversion_judges_again_and_forgives_no_other_fault(store: Store) -> None:
    newest = calibrations(store)
    before = recorded(store, newest.measure("lab", shifted((0.0, 0.0, 0.0))).calibration)
    fault = "the tracker has gone in mid-take"
    advice = ending_advice(fault, rejected=False)
    torn = store.change_demonstration(before.id, verdict=Verdict.REPAIRED, reasons=(fault,), advice=advice)
    newest.measure("lab", [replace(p, world=(p.world[0] + 5.0, *p.world[1:])) for p in shifted((0.0, 0.0, 0.0))])
    (outside,) = newest.convert([torn])
    assert outside.verdict == "reject"
    assert outside.statistics.out_of_workspace == 50
    assert outside.reasons[0] == fault
    assert outside.advice not in ("", advice)
    assert newest.convert([outside], "lab@1") == [torn]


def test_either_all_are_converted_or_none(store: Store) -> None:
    newest = calibrations(store)
    first = newest.measure("lab", shifted((0.1, 0.0, 0.0))).calibration
    rows = [recorded(store, first) for _ in range(2)]
    newest.measure("lab", shifted((0.3, 0.0, 0.0)))
    store.recordings.path(rows[1].recording).unlink()
    with pytest.raises(NotFound, match="is missing"):
        newest.convert(rows)
    assert store.demonstration(rows[0].id) == rows[0]


def test_a_calibration_of_another_station_contradicts_nothing(store: Store) -> None:
    calibrations(store).require_current([recorded(store, Calibration("theirs", offset=(1.0, 0.0, 0.0)))])
