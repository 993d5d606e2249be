"""What the operator sees while demonstrating: state, countdown, takes and verdicts, on one line that changes.

Where the output is no terminal, each change is a line of its own. A press of the pedal or a countdown sounds the bell.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from typing import TextIO

from teachpath_client.reading import HandReading
from teachpath_proto import tracker_pb2

BELL = "\a"
CLEAR_LINE = "\r\x1b[K"
VERDICT_MARKS = {"clean": "+", "repaired": "~", "reject": "x"}
VERDICT_WORDS = {"reject": "rejected"}  # others are words already
SILENCE_TIMEOUT = 3.0  # [s] after which a station that says nothing records nothing; it speaks each second
SILENCE_WARNING = (
    f"the station has said nothing for {SILENCE_TIMEOUT:g} s; what is shown now may not be recorded: "
    "is it still recording?"
)
STATE_TEXTS = {
    "recording": "recording",
    "pausing": "pauses after this take",
    "paused": "paused: pedal, fist or `resume` to go on",
    "lost": "the tracker is lost",
    "": "ended",
}


class Status:
    """Shows the feedback on a recording; its methods may be called from any thread.

    Args:
        out: where it is shown.
        live: whether the line may be written over; default: when `out` is a terminal.
        clock: [s] that never runs back.
    """

    def __init__(self, out: TextIO, *, live: bool | None = None, clock: Callable[[], float] = time.monotonic) -> None:
        self._out = out
        self._live = out.isatty() if live is None else live
        self._lock = threading.Lock()
        self._clock, self._heard = clock, clock()
        self._shown = self._newest = ""

    def on_feedback(self, payload: bytes) -> None:
        """Show a `HandFeedback`."""
        feedback = tracker_pb2.HandFeedback.FromString(payload)
        with self._lock:
            self._heard = self._clock()
            newest = feedback.newest
            if newest.demonstration != self._newest:
                self._newest = newest.demonstration
                self._line(verdict_line(newest))
            self._show(status_line(feedback), bell=feedback.state == "countdown")

    def readings(self, readings: Iterator[HandReading]) -> Iterator[HandReading]:
        """Pass readings on, and warn when the station has sent no feedback for too long."""
        with self._lock:
            self._heard = self._clock()
        for reading in readings:
            with self._lock:
                if self._clock() - self._heard > SILENCE_TIMEOUT:
                    self._show(SILENCE_WARNING, bell=True)
            yield reading

    def end(self) -> None:
        """End the line that was written over."""
        with self._lock:
            if self._live and self._shown:
                self._out.write("\n")
                self._out.flush()

    def _show(self, shown: str, *, bell: bool) -> None:
        if shown == self._shown:
            return
        self._shown = shown
        self._out.write(f"{CLEAR_LINE}{shown}{BELL * bell}" if self._live else f"{shown}\n")
        self._out.flush()

    def _line(self, text: str) -> None:
        self._out.write(f"{CLEAR_LINE if self._live else ''}{text}\n")
        self._shown = ""


def verdict_line(newest: tracker_pb2.DemonstrationReport) -> str:
    """Return a line about a finished take."""
    reasons = f": {newest.advice or '; '.join(newest.reasons)}" if newest.reasons else ""
    mark, word = VERDICT_MARKS.get(newest.verdict, "?"), VERDICT_WORDS.get(newest.verdict, newest.verdict)
    return f"  {mark} take {newest.number} {word}{reasons}"


def status_line(feedback: tracker_pb2.HandFeedback) -> str:
    """Return a line about the state of the recording."""
    if feedback.state == "countdown":
        doing = f"begins in {feedback.countdown_left:.0f} s"
    elif feedback.state in ("recording", "pausing") and feedback.phase != "reach":
        doing = f"{STATE_TEXTS[feedback.state]}: {feedback.phase}"
    else:
        doing = STATE_TEXTS.get(feedback.state, feedback.state)
    takes = f"{feedback.takes} take{'s' if feedback.takes != 1 else ''}"
    left = f", {feedback.takes_left} to go" if feedback.takes_left else ""
    fist = f"; open the fist now to {feedback.pending_command}" if feedback.pending_command else ""
    hint = f"; {feedback.hint}" if feedback.hint else ""
    return f"{feedback.task}: {doing}; {takes}{left}{fist}{hint}"
