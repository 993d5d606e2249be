"""The CyberGlove driver against a device that misbehaves, over a pty."""

from pathlib import Path
from typing import Any

import pytest

from teachpath_client.devices.cyberglove import GloveSource
from teachpath_client.devices.emulators import RecordCorrupter
from teachpath_client.devices.protocol_simulators import GloveSimulator
from teachpath_client.errors import ClientError
from teachpath_client.reading import HandReading
from tests.unit.clients.devices.emulated_devices import (
    GLOVE,
    glove,
    glove_settings,
    seen,
)
from tests.unit.clients.devices.readings import calibration, readings, until

FORMATS = pytest.mark.parametrize("form", ["binary", "ascii"])


@FORMATS
def test_every_whole_sample_of_a_glove_comes_out_once_and_right(tmp_path: Path, form: Any) -> None:
    with (
        glove(tmp_path, corrupt=RecordCorrupter(2, torn=0.2, noise=0.0)) as device,
        GloveSource(glove_settings(tmp_path, format=form)) as source,
    ):
        device.play(readings(99))
        until(device.played.is_set, "all but the last was played")
        device.corrupt = None
        device.play(readings(100)[-1:])
        until(device.played.is_set, "the last was played")
        stream = iter(source)
        found = [next(stream) for _ in device.intact]
    assert device.corrupted > 5
    sent = [seen(reading.flexions) for _, reading in device.intact]
    assert [reading.flexions for reading in found] == [pytest.approx(flexions) for flexions in sent]
    assert not any(reading.tracked for reading in found)


@FORMATS
def test_a_polled_glove_is_asked_for_each_sample(tmp_path: Path, form: Any) -> None:
    with glove(tmp_path) as device, GloveSource(glove_settings(tmp_path, format=form, mode="polled")) as source:
        stream = iter(source)
        for shown in readings(5):
            device.show(shown)
            flexions = seen(shown.flexions)
            until(lambda flexions=flexions: next(stream).flexions == pytest.approx(flexions), "the sample is asked for")
        assert not device.simulator.streaming


def test_a_glove_that_does_not_fit_is_said(tmp_path: Path) -> None:
    with glove(tmp_path, GloveSimulator(calibration(18), cybertouch=False)):
        with pytest.raises(ClientError, match="has 18 sensors, not 22"), GloveSource(glove_settings(tmp_path)):
            pass
        calibration(18).save(tmp_path / "glove.toml")
        with pytest.raises(ClientError, match="no CyberTouch"), GloveSource(glove_settings(tmp_path, touch="phase")):
            pass


def test_a_cybertouch_vibrates_while_the_hand_is_closed_and_never_after_the_end(tmp_path: Path) -> None:
    simulator = GloveSimulator(GLOVE)
    with glove(tmp_path, simulator) as device:
        with GloveSource(glove_settings(tmp_path, touch="closure", amplitude=200)) as source:
            stream = iter(source)
            for flexion, amplitudes in ((0.1, []), (0.9, [200]), (0.5, [200]), (0.1, [200, 0]), (0.9, [200, 0, 200])):
                device.show(HandReading(0.0, (0.0, 0.0, 0.0), None, (flexion,) * 22))
                until(
                    lambda amplitudes=amplitudes: next(stream) and simulator.amplitudes == amplitudes,
                    f"{amplitudes} is felt at {flexion}",
                )
                for _ in range(5):
                    next(stream)
                assert simulator.amplitudes == amplitudes
        until(lambda: simulator.amplitudes[-1] == 0, "the vibration ends")
