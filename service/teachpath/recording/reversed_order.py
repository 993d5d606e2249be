"""Whether samples come in reverse order, so that nothing can be cut from them."""

from __future__ import annotations

from typing import Final

from teachpath.recording.sample_runs import SampleBlock
from teachpath.records import Sample

REVERSED_TIME: Final = 0.5  # [s] for which every sample is older than the one before
MIN_REVERSED: Final = 5  # such samples in a row; fewer may be a burst that the network has turned round
HINT: Final = (
    "the tracker sends its samples in reverse order, each older than the one before: nothing can be recorded; send "
    "them in the order in which they were measured"
)


class ReversedOrder:
    """Compares each sample of a tracker with the one that came before it, by number and by the device's clock.

    Attributes:
        hint: what is wrong and what to do; empty while samples come in a usable order.
    """

    def __init__(self) -> None:
        self.hint: str = ""
        self._last: tuple[int, int, int] | None = None  # number, device_ns and receive_ns of the last one
        self._count = 0
        self._since_ns = 0

    def observe(self, sample: Sample) -> bool:
        """Add the sample that came next; return whether it is the one that shows the reverse order."""
        last, self._last = self._last, (sample.sequence, sample.device_ns, sample.receive_ns)
        if last is None or (sample.sequence >= last[0] and sample.device_ns >= last[1]):
            self._count, self.hint = 0, ""
            return False
        if not self._count:
            self._since_ns = last[2]
        self._count += 1
        if self.hint or self._count < MIN_REVERSED or sample.receive_ns - self._since_ns < REVERSED_TIME * 1e9:
            return False
        self.hint = HINT
        return True

    def continues(self, sequence: int, device_ns: int) -> bool:
        """Tell whether a sample that comes next would be in order."""
        return self._last is None or (sequence >= self._last[0] and device_ns >= self._last[1])

    def observe_run(self, block: SampleBlock, end: int) -> None:
        """Add the samples of a run that ends before `end` and continues the last sample."""
        self._last = (block.sequence[end - 1], block.device_ns[end - 1], block.receive_ns[end - 1])
        self._count, self.hint = 0, ""
