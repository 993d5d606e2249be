"""A stream in reverse order makes no demonstration, and the hand is told within a second why."""

from collections.abc import Callable

import numpy as np
import pytest

from teachpath.io.store.store import Store
from teachpath.recorder.recording_setup import RecordingSetup
from teachpath.recorder.session import RecordingSession
from teachpath.records import Sample
from tests.faults.routes import CALIBRATION, SCENE, SETTINGS
from tests.faults.streams import PERIOD_NS, RATE, START_NS, shown


def received(samples: list[Sample]) -> list[Sample]:
    """Return samples as they are received, one a period."""
    return [sample._replace(receive_ns=START_NS + k * PERIOD_NS) for k, sample in enumerate(samples)]


def session(store: Store) -> RecordingSession:
    store.ensure_task("lift", scene=SCENE.name, calibration=CALIBRATION.name)
    return RecordingSession(store, SETTINGS, RecordingSetup("lift", "glove", CALIBRATION, SCENE, RATE))


def whole(samples: list[Sample]) -> list[Sample]:
    return samples[::-1]


def numbered_anew(samples: list[Sample]) -> list[Sample]:
    """Return them in reverse order, with numbers that rise."""
    return [sample._replace(sequence=number) for number, sample in enumerate(samples[::-1], 1)]


@pytest.mark.parametrize("turned", [whole, numbered_anew])
def test_reverse_order_is_told_within_a_second(store: Store, turned: Callable[[list[Sample]], list[Sample]]) -> None:
    recording = session(store)
    samples = received(turned([event.sample for event in shown(np.random.default_rng(1)).events]))
    for sample in samples[: round(RATE)]:
        recording.add(sample)
    assert "reverse order" in recording.status().hint
    for sample in samples[round(RATE) :]:
        recording.add(sample)
    finished = recording.finish()
    assert all(str(made.verdict) == "reject" for made, _ in finished)
    notes = recording.status(with_statistics=True).statistics
    assert notes is not None
    assert any("reverse order" in note for note in notes.notes)


def test_samples_that_were_turned_round_on_their_way_are_no_reverse_order(store: Store) -> None:
    recording = session(store)
    samples = [event.sample for event in shown(np.random.default_rng(2)).events]
    turned = [sample for k in range(0, len(samples), 20) for sample in samples[k : k + 20][::-1]]
    for sample in received(turned):
        recording.add(sample)
        assert "reverse order" not in recording.status().hint
    recording.finish()


def test_a_tracker_that_sends_in_order_again_is_told_of_no_reverse_order(store: Store) -> None:
    recording = session(store)
    samples = [event.sample for event in shown(np.random.default_rng(3)).events]
    for sample in received([*samples[:60][::-1], *samples[60:]]):
        recording.add(sample)
    assert "reverse order" not in recording.status().hint
    recording.finish()


@pytest.mark.parametrize("step", [-1, 0])
def test_samples_that_come_late_or_twice_for_ever_are_not_kept_for_ever(store: Store, step: int) -> None:
    recording = session(store)
    (first, *_) = [event.sample for event in shown(np.random.default_rng(3)).events]
    count, ns = 1000, round(2 * SETTINGS.longest_reach * 1e9 / 1000)
    for k in range(count):
        number, stamp = first.sequence + count + step * k, START_NS + step * k * ns
        recording.add(first._replace(sequence=number, device_ns=stamp, receive_ns=START_NS + k * ns))
    status = recording.status(with_statistics=True)
    assert status.statistics is not None
    assert status.statistics.received == count
    assert status.idle >= 0.9 * count
    assert any("a long reach began anew" in note for note in status.statistics.notes)
    recording.finish()
