"""The newest samples of a stream by their numbers, to tell duplicates from conflicts."""

from __future__ import annotations

from teachpath.records import Sample, SampleColumns, Vector

HISTORY_SIZE = 512  # samples that are remembered
NOT_SEEN: tuple[int, int, Vector] = (-1, 0, (0.0, 0.0, 0.0))


class SampleHistory:
    """Remembers device time and position of the newest samples."""

    def __init__(self) -> None:
        self._samples = [NOT_SEEN] * HISTORY_SIZE
        self._runs: list[tuple[SampleColumns, int, int]] = []  # that wait until somebody asks, or until they are many
        self._waiting = 0

    def keep(self, sample: Sample) -> None:
        """Remember a sample."""
        self._take_in()
        self._samples[sample.sequence % HISTORY_SIZE] = (sample.sequence, sample.device_ns, sample.position)

    def keep_run(self, samples: SampleColumns, begin: int, end: int) -> None:
        """Remember the samples from `begin` to before `end`."""
        self._runs.append((samples, begin, end))
        self._waiting += end - begin
        if self._waiting >= HISTORY_SIZE:
            self._take_in()

    def knows(self, sequence: int) -> bool:
        """Tell whether the sample of a number is remembered."""
        self._take_in()
        return self._samples[sequence % HISTORY_SIZE][0] == sequence

    def holds(self, sample: Sample) -> bool:
        """Tell whether the same sample is remembered."""
        self._take_in()
        return self._samples[sample.sequence % HISTORY_SIZE] == (sample.sequence, sample.device_ns, sample.position)

    def device_ns(self, sequence: int) -> int | None:
        """Return the device time of a number, or None when it is not remembered."""
        self._take_in()
        number, device_ns, _ = self._samples[sequence % HISTORY_SIZE]
        return device_ns if number == sequence else None

    def _take_in(self) -> None:
        """Remember the runs that wait sample by sample."""
        for samples, begin, end in self._runs:
            newest = slice(max(begin, end - HISTORY_SIZE), end)
            values = [column[newest].tolist() for column in (samples.sequence, samples.device_ns, samples.position)]
            for sequence, device_ns, position in zip(*values, strict=True):
                self._samples[sequence % HISTORY_SIZE] = (sequence, device_ns, tuple(position))
        if self._runs:
            self._runs, self._waiting = [], 0
