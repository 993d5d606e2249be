"""Stored takes to export: whole, lossy, torn, without a glove, without orientations."""

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from teachpath.io.store.store import Store
from teachpath.recorder.annotations import Annotations
from teachpath.recorder.recording_setup import RecordingSetup
from teachpath.recorder.session import RecordingSession
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Calibration, Demonstration, Sample, Scene, Trajectory
from teachpath_proto.sample_rules import GRASP_BUTTON
from tests.unit.recording.hands import demonstration

EMPTY_SCENE = Scene("empty")
LAB = Calibration("lab", 0.5, (0.6, 0.0, 0.8, 0.0), (0.1, 0.2, 0.3))
SETTINGS = RecordingSettings()


def exact(samples: Sequence[Sample]) -> list[Sample]:
    """Return samples whose numbers need every digit, as the wire carries them: flexions in single precision."""
    random = np.random.default_rng(1)
    return [
        s._replace(
            position=tuple((np.array(s.position) + random.normal(0.0, 1e-3, 3)).tolist()),
            flexions=tuple(np.float32(s.flexions).tolist()),
            receive_ns=s.receive_ns + int(random.integers(0, 500_000)),
        )
        for s in samples
    ]


def whole() -> list[Sample]:
    return exact(demonstration())


def lossy() -> list[Sample]:
    """Lose one sample, send one twice and one late."""
    shown = exact(demonstration(transport=80))
    del shown[60]
    shown.insert(70, shown[69])
    shown[40], shown[41] = shown[41], shown[40]
    return [s._replace(tracked=i != 50) for i, s in enumerate(shown)]


def bare() -> list[Sample]:
    """Show with a button, without a glove and orientations."""
    return [
        s._replace(flexions=(), orientation=None, buttons=GRASP_BUTTON if s.flexions[0] > 0.5 else 0)
        for s in exact(demonstration())
    ]


def led() -> list[Sample]:
    """Show with an arm that is led by hand, without a glove."""
    random = np.random.default_rng(2)
    return [s._replace(joints=tuple(random.uniform(-3.0, 3.0, 7).tolist())) for s in bare()]


TAKES: dict[str, Callable[[], list[Sample]]] = {"whole": whole, "lossy": lossy, "bare": bare, "led": led}


def record(store: Store, samples: Sequence[Sample], *, gone: bool = False, rate: float = 50.0) -> Demonstration:
    """Record a take under a calibration of its own; `gone`: the tracker leaves before the hand has come to rest."""
    store.ensure_task("lift", scene="empty", calibration="lab")
    session = RecordingSession(store, SETTINGS, RecordingSetup("lift", "glove", LAB, EMPTY_SCENE, rate))
    session.counter.count_refused("a payload was no sample")
    finished = [session.add(sample) for sample in (samples[:-20] if gone else samples)]
    finished += [session.on_tracker_lost("the tracker has gone in mid-take")] if gone else session.finish()
    ((row, _),) = [f for f in finished if f is not None]
    return row


def trajectory(store: Store) -> Callable[[Demonstration], Trajectory]:
    return Annotations(store, SETTINGS, lambda _: EMPTY_SCENE).trajectory


def said(row: Demonstration) -> Iterator[object]:
    """Yield what must be the same of a demonstration that was exported and imported."""
    account = row.statistics
    yield from (row.verdict, row.reasons, row.left_out, row.transport, row.samples, row.duration, row.calibration)
    yield from (row.source, account.received, account.lost, account.duplicated, account.reordered, account.refused)
    yield from (account.untracked, account.gaps, account.longest_gap_ns, account.declared_rate, account.seen_rate)
