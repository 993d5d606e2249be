"""Whether samples come in reverse order, so that nothing can be cut from them."""

from __future__ import annotations

from typing import Final

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
        self._last: Sample | None = None
        self._count = 0
        self._since_ns = 0

    def observe(self, sample: Sample) -> bool:
        """Add the sample that came next; return whether it is the one that shows the reverse order."""
        last, self._last = self._last, sample
        if last is None or (sample.sequence >= last.sequence and sample.device_ns >= last.device_ns):
            self._count, self.hint = 0, ""
            return False
        if not self._count:
            self._since_ns = last.receive_ns
        self._count += 1
        if self.hint or self._count < MIN_REVERSED or sample.receive_ns - self._since_ns < REVERSED_TIME * 1e9:
            return False
        self.hint = HINT
        return True
