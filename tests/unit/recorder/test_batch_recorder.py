"""Samples recorded by the batch become what they become one by one: status, statistics, rows, files, for any faults."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import count, pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from teachpath.errors import UnusableSample
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.io.wire import decode_sample, encode_sample
from teachpath.recorder.batch_recorder import BatchRecorder
from teachpath.recorder.presence import Presence
from teachpath.recorder.recording_setup import RecordingSetup
from teachpath.recorder.run_session import RunSession
from teachpath.recorder.sample_queues import QueueItem, SampleQueues
from teachpath.recorder.take import FinishedTake
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Demonstration, RecordingStatus, Routine, Sample
from teachpath_proto.keys import Keys
from tests.faults.faults import FAULTS
from tests.faults.routes import CALIBRATION, SCENE
from tests.faults.streams import PERIOD_NS, RATE, shown

SETTINGS = RecordingSettings(longest_reach=2.0, fist_time=0.2, fist_distance=0.1)
ROUTINES = (Routine(), Routine(one_by_one=True), Routine(takes=1), Routine(armed=True))
SAMPLE_ORIENTATION = (0.6, 0.0, 0.8, 0.0)


TASKS = (f"lift-{n}" for n in count())


class Recording:
    """A running recording in a store."""

    def __init__(
        self, store: Store, task: str, tracker: str, routine: Routine, rate: float, kind: type[RunSession] = RunSession
    ) -> None:
        self.store, self.task = store, task
        store.ensure_task(task, scene=SCENE.name, calibration=CALIBRATION.name)
        ids = (f"demo-{task}-{n}" for n in count())
        setup = RecordingSetup(task, tracker, CALIBRATION, SCENE, rate, routine, ids.__next__)
        self.session = kind(store, SETTINGS, setup, clock=lambda: 0.0)

    def status(self) -> RecordingStatus:
        return self.session.status(with_hand=True, with_statistics=True)

    def made(self) -> list[tuple[Demonstration, bytes]]:
        """Return the rows without what the moment of their making says, and what their files hold before it."""
        rows = self.store.demonstrations(self.task)
        contents = [self.store.recordings.path(row.recording).read_bytes() for row in rows]
        return [
            (replace(row, created_ns=0, digest=None), content[: content.index(b"\x05\0\0\0facts")])
            for row, content in zip(rows, contents, strict=True)
        ]


@pytest.fixture(scope="module")
def stores(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Store, Store]]:
    folder = tmp_path_factory.mktemp("batches")
    one, other = (Store(StoreSettings(data_dir=str(folder / name), database="sqlite://")) for name in "ab")
    yield one, other
    one.close()
    other.close()


def add_alone(session: RunSession, item: QueueItem) -> None:
    assert item.payload is not None
    try:
        session.add(decode_sample(session.tracker, item.payload, item.receive_ns), item.payload)
    except UnusableSample as error:
        session.counter.count_refused(str(error), error.sequence)


def items_of(rng: np.random.Generator, takes: int, chosen: list[tuple[int, int]], odd: float) -> list[QueueItem]:
    """Return what arrives of some takes, each with the chosen faults; a share of the samples is odd beside that."""
    items: list[QueueItem] = []
    numbers, later = 0, 0
    for _ in range(takes):
        stream = shown(rng)
        for which, strength in chosen:
            fault = FAULTS[which % len(FAULTS)]
            stream = fault.change(stream, rng, fault.strengths[strength % len(fault.strengths)])
        glove = rng.choice(np.array([0, 18, 22]))
        for event in stream.events:
            s = event.sample
            # A flexion as it comes over the wire, at times on a limit.
            flexion = rng.choice(
                np.array([s.flexions[0], SETTINGS.close_at, SETTINGS.open_at]), p=[1 - odd, odd / 2, odd / 2]
            )
            s = s._replace(
                sequence=s.sequence + numbers,
                device_ns=s.device_ns + later + int(rng.random() < odd / 5) * 40_000_000,
                receive_ns=s.receive_ns + later,
                flexions=(float(flexion),) * int(glove),
                orientation=SAMPLE_ORIENTATION if rng.random() < 0.9 else None,
                buttons=int(rng.choice(np.array([0, 1, 2, 3]), p=[1 - 3 * odd / 4, odd / 4, odd / 4, odd / 4])),
                tracked=s.tracked and rng.random() > odd / 5,
            )
            items.append(QueueItem(b"broken" if event.refused else encode_sample(s), s.receive_ns))
        numbers, later = numbers + stream.sent, later + (stream.sent + 1) * PERIOD_NS
    return items


@settings(max_examples=12)
@given(
    seed=st.integers(0, 100_000),
    chosen=st.lists(st.tuples(st.integers(0, 50), st.integers(0, 5)), max_size=3),
    odd=st.sampled_from([0.0, 0.0, 0.003, 0.05]),
    routine=st.sampled_from(ROUTINES),
    borders=st.lists(st.integers(0, 1000), max_size=6),
    rate=st.sampled_from([0.0, RATE]),
)
def test_a_batch_is_recorded_as_its_samples_one_by_one(
    stores: tuple[Store, Store],
    seed: int,
    chosen: list[tuple[int, int]],
    odd: float,
    routine: Routine,
    borders: list[int],
    rate: float,
) -> None:
    task = next(TASKS)
    alone, batched = (Recording(store, task, "glove", routine, rate) for store in stores)
    other = Recording(stores[1], next(TASKS), "other", routine, rate)  # whose samples come in the same batches
    rng = np.random.default_rng(seed)
    items, others = items_of(rng, 2, chosen, odd), items_of(rng, 1, [], 0.0)
    presence = Presence(lambda: 0.0)
    recorder = BatchRecorder(SampleQueues(Keys("x"), presence, 1000), presence, SETTINGS)
    for begin, end in pairwise(sorted({0, len(items), *(b for b in borders if b < len(items))})):
        for item in items[begin:end]:
            add_alone(alone.session, item)
        recorder.record([(other.session, others[begin:end]), (batched.session, items[begin:end])])
        assert batched.status() == alone.status()
    for recording in (alone, batched, other):
        recording.session.finish()
    assert batched.status() == alone.status()
    assert batched.made() == alone.made()


class CountingSession(RunSession):
    """Counts the samples that are added one by one."""

    added = 0

    def add(self, sample: Sample, payload: bytes = b"") -> FinishedTake | None:
        self.added += 1
        return super().add(sample, payload)


def test_most_samples_of_a_stream_are_recorded_by_the_run(stores: tuple[Store, Store]) -> None:
    session = Recording(stores[0], next(TASKS), "glove", Routine(), RATE, CountingSession).session
    assert isinstance(session, CountingSession)
    items = items_of(np.random.default_rng(1), 3, [], 0.0)
    presence = Presence(lambda: 0.0)
    BatchRecorder(SampleQueues(Keys("x"), presence, 1000), presence, SETTINGS).record([(session, items)])
    assert session.added < len(items) / 2
    assert session.counter.received == len(items)
    session.finish()
