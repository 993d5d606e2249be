"""Records what came from several trackers: decoded as one batch, then recorded by the run where nothing happens."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate
from typing import Final

from teachpath.errors import UnusableSample
from teachpath.io.wire import SampleBatchDecoder, decode_sample
from teachpath.recorder.presence import Presence
from teachpath.recorder.run_session import RunSession
from teachpath.recorder.sample_queues import QueueItem, SampleQueues
from teachpath.recording.sample_runs import SampleBlock, SampleRun
from teachpath.recording.settings import RecordingSettings

SMALLEST_BATCH: Final = 12  # samples; of fewer, columns cost more than one sample after the other

Batch = tuple[RunSession, Sequence[QueueItem]]


class BatchRecorder:
    """Records batches of samples, exactly as if each sample were recorded alone; not thread-safe."""

    def __init__(self, queues: SampleQueues, presence: Presence, settings: RecordingSettings) -> None:
        self._queues = queues
        self._presence = presence
        self._settings = settings
        self._decoder = SampleBatchDecoder()

    def record(self, batches: Sequence[Batch]) -> None:
        """Record the samples of some trackers, which are decoded together."""
        batches = [(session, items) for session, items in batches if items]
        for session, items in batches:
            if items[-1].payload is not None:
                self._presence.on_sample(session.tracker)
            if dropped := self._queues.dropped(session.tracker):
                session.counter.note(f"{dropped} samples came faster than they can be recorded, and were turned away")
        if sum(len(items) for _, items in batches) < SMALLEST_BATCH:
            for session, items in batches:
                for item in items:
                    self._record_item(session, item)
        else:
            self._record_block(batches)

    def _record_block(self, batches: Sequence[Batch]) -> None:
        items = [item for _, batch in batches for item in batch]
        payloads = [item.payload or b"" for item in items]
        columns, usable = self._decoder.decode(payloads, [item.receive_ns for item in items])
        ends = list(accumulate(len(batch) for _, batch in batches))
        block = SampleBlock(columns, usable, [0, *ends[:-1]], self._settings)
        for (session, _), end in zip(batches, ends, strict=True):
            for run in block.next_runs(end):
                self._record_run(session, block, run, items, payloads)

    def _record_run(
        self,
        session: RunSession,
        block: SampleBlock,
        run: SampleRun,
        items: Sequence[QueueItem],
        payloads: Sequence[bytes],
    ) -> None:
        at = run.begin
        while at < run.end:
            try:
                count = session.add_run(block, run, at, payloads)
            except Exception as error:  # one take's fault must not end the others
                session.fail(f"recording failed: {error!r}")
                return
            if not count:
                self._record_item(session, items[at])
            at += count or 1

    def _record_item(self, session: RunSession, item: QueueItem) -> None:
        payload, receive_ns = item
        try:
            if payload is None:
                session.on_tracker_lost("the tracker has gone" + " in mid-take" * session.is_carrying)
            else:
                session.add(decode_sample(session.tracker, payload, receive_ns), payload)
        except UnusableSample as error:
            session.counter.count_refused(str(error), error.sequence)
        except Exception as error:  # one take's fault must not end the others
            session.fail(f"recording failed: {error!r}")
