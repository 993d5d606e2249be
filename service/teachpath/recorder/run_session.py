"""A recording that takes samples by the run, where they change nothing but counts."""

from __future__ import annotations

from collections.abc import Sequence

from teachpath.recorder.session import RecordingSession
from teachpath.recording.sample_runs import SampleBlock, SampleRun
from teachpath.records import Phase


class RunSession(RecordingSession):
    """A recording whose samples come by the batch; all becomes what `add` would make of each sample."""

    def add_run(self, block: SampleBlock, run: SampleRun, begin: int, payloads: Sequence[bytes]) -> int:
        """Write samples of a run from `begin` on, as far as they change nothing but counts; return how many.

        None is written when the next one may change more: then `add` decides on it.

        Args:
            payloads: of all samples of the block, as they came.
        """
        if not (run.is_steady and self.state.is_writing and self._continues(block, begin)):
            return 0
        self._look_for_object()
        if not (self._commands.is_idle_in(run) and self._has_room(block.device_ns[run.end - 1])):
            return 0
        count = self._segmenter.push_unchanged(
            run.grip, block.device_ns, range(begin, run.end), lambda at: self._to_world(block.position(at))
        )
        if count:
            self._write_run(block, run, begin, begin + count, payloads)
        return count

    def _continues(self, block: SampleBlock, begin: int) -> bool:
        sequence, device_ns = block.sequence[begin], block.device_ns[begin]
        return self.counter.continues(sequence, device_ns) and self._order.continues(sequence, device_ns)

    def _has_room(self, device_ns: int) -> bool:
        """Tell whether the open take, if it still reaches, does not begin anew before this time."""
        if self._segmenter.phase is not Phase.REACH:
            return True
        return bool(self._take.samples) and self._take.seconds_until(device_ns) <= self._settings.longest_reach

    def _write_run(self, block: SampleBlock, run: SampleRun, begin: int, end: int, payloads: Sequence[bytes]) -> None:
        self.counter.observe_run(block, begin, end)
        self._order.observe_run(block, end)
        self._newest.keep(block.columns, end - 1)
        self._commands.observe_run(block, run, (begin, end), self._to_world)
        self._take.write_run(block.columns.select(slice(begin, end), self.tracker), payloads[begin:end])
