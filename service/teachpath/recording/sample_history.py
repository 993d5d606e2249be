"""The newest samples of a stream by their numbers, to tell duplicates from conflicts."""

from __future__ import annotations

from teachpath.records import Sample, Vector

HISTORY_SIZE = 512  # samples that are remembered
NOT_SEEN: tuple[int, int, Vector] = (-1, 0, (0.0, 0.0, 0.0))


class SampleHistory:
    """Remembers device time and position of the newest samples."""

    def __init__(self) -> None:
        self._samples = [NOT_SEEN] * HISTORY_SIZE

    def keep(self, sample: Sample) -> None:
        """Remember a sample."""
        self._samples[sample.sequence % HISTORY_SIZE] = (sample.sequence, sample.device_ns, sample.position)

    def knows(self, sequence: int) -> bool:
        """Tell whether the sample of a number is remembered."""
        return self._samples[sequence % HISTORY_SIZE][0] == sequence

    def holds(self, sample: Sample) -> bool:
        """Tell whether the same sample is remembered."""
        return self._samples[sample.sequence % HISTORY_SIZE] == (sample.sequence, sample.device_ns, sample.position)

    def device_ns(self, sequence: int) -> int | None:
        """Return the device time of a number, or None when it is not remembered."""
        number, device_ns, _ = self._samples[sequence % HISTORY_SIZE]
        return device_ns if number == sequence else None
