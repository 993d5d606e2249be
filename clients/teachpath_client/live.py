"""Recording from a live source until somebody ends it, and the calibration of a glove."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

from teachpath_client.devices.cyberglove import GloveDialogue, GloveSettings, Raw, connect
from teachpath_client.devices.glove_calibration import GloveCalibration
from teachpath_client.devices.source import Source, TouchSource
from teachpath_client.link import ClientError, Link
from teachpath_client.tracker import Tracker
from teachpath_proto import tracker_pb2
from teachpath_proto.keys import Keys

ASK = 0.1  # [s] between questions for the phase
TRANSPORT = "transport"
MEASURED = 100  # samples of a hand that is held still
PATIENCE = 5.0  # [s] without a sample


@contextmanager
def ended_by_signals(source: Source) -> Iterator[None]:
    """Close the source at the first Ctrl-C or SIGTERM, so that the recording ends with its handshake."""
    numbers = (signal.SIGINT, signal.SIGTERM)

    def end(_number: int, _frame: FrameType | None) -> None:
        source.close()
        for number in numbers:
            signal.signal(number, before[number])

    before = {number: signal.signal(number, end) for number in numbers}
    try:
        yield
    finally:
        for number in numbers:
            signal.signal(number, before[number])


def record_live(
    tracker: Tracker, source: Source, task: str, *, scene: str = "", calibration: str = "", speed: float = 1.0
) -> tracker_pb2.RecordingReport:
    """Record `task` from a source until it ends, and return the station's account, whatever ended it."""
    tracker.start(task, scene=scene, calibration=calibration)
    try:
        tracker.publish(source, speed=speed)
    finally:
        report = tracker.stop()
    return report


@contextmanager
def felt(source: Source, link: Link, tracker: str, prefix: str) -> Iterator[None]:
    """Let the hand feel, as far as the source can, that it carries the object by what the station says."""
    if not source.capabilities.touch:
        yield
        return
    over = threading.Event()
    arguments = (source, link, tracker, Keys(prefix).recorder_status, over)
    thread = threading.Thread(target=_follow_phase, args=arguments, name="feel")
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()


def _follow_phase(source: TouchSource, link: Link, tracker: str, key: str, over: threading.Event) -> None:
    while not over.wait(ASK):
        try:
            status = tracker_pb2.RecorderStatus.FromString(link.ask(key, timeout=1.0))
        except ClientError:  # the recording itself tells when the station is gone
            continue
        phases = [recording.phase for recording in status.recordings if recording.tracker == tracker]
        source.touch(TRANSPORT in phases)
    source.touch(False)


def calibrate_glove(settings: GloveSettings, tell: Callable[[str], object]) -> GloveCalibration:
    """Measure the open hand and the fist with a glove; `tell` shows a sentence and returns when it was done.

    Raises:
        ClientError: the glove does not answer, falls silent, or cannot tell the two hands apart.
    """
    measured = []
    dialogue = GloveDialogue(settings, 0)
    with connect(settings, dialogue) as connection:
        for sentence in ("Open the hand, fingers straight", "Make a fist"):
            tell(sentence)
            while connection.take(0.0):
                pass
            taken = [connection.take(PATIENCE) for _ in range(MEASURED)]
            measured.append([sample for sample in map(_raw, taken) if sample is not None])
    return GloveCalibration.between(*measured)


def _raw(taken: tuple[float, Raw] | None) -> Raw | None:
    return taken[1] if taken else None
