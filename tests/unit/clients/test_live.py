import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from teachpath_client.__main__ import main
from teachpath_client.devices.cyberglove import GloveSettings
from teachpath_client.devices.emulators import Emulator
from teachpath_client.devices.glove_calibration import GloveCalibration
from teachpath_client.devices.playback import PlaybackSource
from teachpath_client.devices.protocol_simulators import GloveSimulator
from teachpath_client.devices.source import Capabilities
from teachpath_client.errors import ClientError
from teachpath_client.live import HapticFeedback, calibrate_glove, ended_by_signals, record_live
from teachpath_client.reading import HandReading
from teachpath_client.tracker import Tracker
from teachpath_proto import tracker_pb2
from tests.unit.clients.devices.readings import calibration, readings
from tests.unit.clients.test_tracker import MemoryLink

OPEN_READING = HandReading(0.0, (0.0, 0.0, 0.0), None, (0.0,) * 22)
CLOSED_READING = HandReading(0.0, (0.0, 0.0, 0.0), None, (1.0,) * 22)


class Touched(PlaybackSource):
    """A source that remembers what the hand felt."""

    def __init__(self) -> None:
        super().__init__(readings(3), rate=50.0, sensors=22)
        self.felt: list[bool] = []

    @property
    def capabilities(self) -> Capabilities:
        return Capabilities(50.0, 22, True, True, touch=True)

    def touch(self, holding: bool) -> None:
        if self.felt[-1:] != [holding]:
            self.felt.append(holding)


def tracker(link: MemoryLink) -> Tracker:
    return Tracker(link, "glove", prefix="lab", clock=lambda: link.now, sleep=link.sleep)  # type: ignore[arg-type]


@contextmanager
def glove(folder: Path) -> Iterator[Emulator]:
    with Emulator(GloveSimulator(calibration()), folder / "glove", rate=400.0, hold=True) as emulator:
        yield emulator


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_the_first_signal_ends_the_source_and_the_recording_by_its_handshake(number: signal.Signals) -> None:
    link, source, before = MemoryLink(), PlaybackSource(readings(50), rate=50.0, sensors=22), signal.getsignal(number)

    def sleep(seconds: float) -> None:
        link.now += seconds
        if len(link.sent) == 10:
            os.kill(os.getpid(), number)

    told = Tracker(link, "glove", prefix="lab", clock=lambda: link.now, sleep=sleep)  # type: ignore[arg-type]
    with ended_by_signals(source), source:
        report = record_live(told, source, "lift")
        assert signal.getsignal(number) == before
    assert report.received == len(link.sent) == 11
    stop = tracker_pb2.StopRecording.FromString(link.asked[-1][1])
    assert (stop.last_sequence, stop.discard) == (11, False)


def test_a_source_that_fails_leaves_what_it_showed() -> None:
    def breaking() -> Iterator[HandReading]:
        yield from readings(5)
        raise ClientError("the cable is torn")

    link = MemoryLink()
    with pytest.raises(ClientError, match="torn"):
        record_live(tracker(link), breaking(), "lift")  # type: ignore[arg-type]
    stop = tracker_pb2.StopRecording.FromString(link.asked[-1][1])
    assert (stop.last_sequence, stop.discard) == (5, False)


def told(holding: bool) -> bytes:
    return tracker_pb2.HandFeedback(holding=holding).SerializeToString()


def test_the_hand_feels_what_the_station_says_and_nothing_after_the_last_reading() -> None:
    source, now = Touched(), [0.0]
    haptic = HapticFeedback(source, clock=lambda: now[0])
    stream = haptic.readings(iter(readings(5)))
    next(stream)
    for holding in (True, True, False, True):
        haptic.on_feedback(told(holding))
        next(stream, None)
    assert source.felt == [True, False, True]
    assert list(stream) == []
    assert source.felt == [True, False, True, False]


def test_the_vibration_ends_when_the_station_is_gone() -> None:
    source, now = Touched(), [0.0]
    haptic = HapticFeedback(source, clock=lambda: now[0])
    stream = haptic.readings(iter(readings(4)))
    haptic.on_feedback(told(True))
    for seconds, felt in ((0.9, [True]), (2.9, [True]), (3.1, [True, False])):
        now[0] = seconds
        next(stream)
        assert source.felt == felt


def test_a_glove_is_calibrated_by_an_open_hand_and_a_fist(tmp_path: Path) -> None:
    with glove(tmp_path) as emulator:
        hands = iter([OPEN_READING, CLOSED_READING])

        def tell(_sentence: str) -> None:
            emulator.show(next(hands))

        made = calibrate_glove(GloveSettings(str(tmp_path / "glove")), tell)
    true = calibration()
    assert made.offset == tuple(map(float, true.raw(OPEN_READING.flexions)))
    assert made.flexions(true.raw(CLOSED_READING.flexions)) == pytest.approx((1.0,) * 22)
    assert made.gain[-1] == 0.0


def test_the_command_line_says_what_is_wrong(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    for arguments, sentence in (
        (["tracker", "--source", "fastrak", "--option", "port=none", "--speed", "2"], "measures in real time"),
        (["tracker", "--source", "fastrak", "--option", f"port={tmp_path}/none"], "is the device plugged in"),
        (["glove-calibrate", "x.toml", "--option", f"port={tmp_path}/none"], "is the device plugged in"),
    ):
        with pytest.raises(SystemExit, match=sentence):
            main(arguments)
    with pytest.raises(SystemExit):
        main(["tracker", "--source", "fastrak", "--option", "port"])
    assert "port is not KEY=VALUE" in capsys.readouterr().err


def test_the_command_line_lists_the_sources(capsys: pytest.CaptureFixture[str]) -> None:
    main(["sources"])
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == sorted(line.split()[0] for line in lines)
    assert any(line.startswith("hand         Polhemus FASTRAK and CyberGlove") for line in lines)


def test_a_calibration_that_was_made_can_be_used(tmp_path: Path) -> None:
    GloveCalibration.between([[50] * 22], [[150] * 22]).save(tmp_path / "glove.toml")
    assert GloveCalibration.load(tmp_path / "glove.toml").flexions([100] * 22) == (0.5,) * 22
