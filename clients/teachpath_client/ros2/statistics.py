"""What of a topic became no reading: what was refused, what came twice, and what never came."""

from __future__ import annotations

from collections.abc import Iterator

from teachpath_client.ros2.wire import Attachment

MAX_PUBLISHERS = 1000  # whose numbers are remembered


class TopicStatistics:
    """Counts what of a topic became no reading.

    Args:
        name: of the topic.

    Attributes:
        repeated: messages whose stamp is not later than that of the one before.
        overflowed: messages for which there was no room while they waited.
    """

    def __init__(self, name: str) -> None:
        self._name = name
        self.repeated: int = 0
        self.overflowed: int = 0
        self._lost = 0
        self._refused: dict[str, int] = {}
        self._last: dict[bytes, int] = {}  # number of the newest message, by publisher

    def refuse(self, name: str) -> bool:
        """Count a message of a topic that is refused; tell whether it is the first one of it."""
        first = name not in self._refused
        self._refused[name] = self._refused.get(name, 0) + 1
        return first

    def sent(self, attached: bytes) -> int:
        """Count the numbers of a publisher that are missing; return when the message was sent [ns], 0: not known."""
        try:
            attachment = Attachment.unpack(attached)
        except ValueError:
            return 0
        before = self._last.get(attachment.gid)
        if before is not None and attachment.sequence > before:
            self._lost += attachment.sequence - before - 1
        if before is not None or len(self._last) < MAX_PUBLISHERS:
            self._last[attachment.gid] = attachment.sequence
        return attachment.stamp_ns

    def sentences(self) -> Iterator[str]:
        """Say all of it that is not zero."""
        for name, refused in self._refused.items():
            yield f"{name}: messages refused: {refused}"
        for number, what in (
            (self._lost, "messages that never came, by the numbers of their publishers"),
            (self.repeated, "messages left out, since their stamps are not later than those before"),
            (self.overflowed, "messages left out, since too many waited"),
        ):
            if number:
                yield f"{self._name}: {what}: {number}"
