"""The FASTRAK driver against a device that misbehaves, over a pty."""

import time
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from teachpath_client.devices.cyberglove import GloveSource
from teachpath_client.devices.emulators import Emulator, RecordCorrupter
from teachpath_client.devices.fastrak import FastrakSource
from teachpath_client.devices.protocol_simulators import FastrakSimulator, GloveSimulator
from teachpath_client.errors import ClientError
from teachpath_client.reading import HandReading
from tests.unit.clients.devices.emulated_devices import (
    GLOVE,
    RATE,
    ends_with,
    fastrak,
    fastrak_settings,
    glove,
    glove_settings,
    place,
    whole,
)
from tests.unit.clients.devices.readings import gather, readings, until

LINE = 0.5  # [s] that a record is dated back at most, for the bytes behind it
FORMATS = pytest.mark.parametrize("form", ["binary", "ascii"])


@FORMATS
def test_every_whole_record_comes_out_once_and_right_among_torn_ones_and_noise(tmp_path: Path, form: Any) -> None:
    shown = readings(300)
    with (
        fastrak(tmp_path, corrupt=RecordCorrupter(1, torn=0.2, noise=0.2)) as device,
        FastrakSource(fastrak_settings(tmp_path, format=form)) as source,
    ):
        device.play(shown[:-1])
        until(device.played.is_set, "all but the last was played")
        device.corrupt = None
        device.play(shown[-1:])
        got = gather(iter(source), ends_with(device))
    assert device.corrupted > 30
    sent = whole(device)
    spots = [place(reading) for reading in got]
    assert [spot for spot in spots if spot in set(sent)] == sent
    assert len(spots) == len(sent)
    by_place = {place(reading): reading for _, reading in device.intact}
    for reading in got:
        true = by_place[place(reading)]
        assert reading.position == pytest.approx(true.position, abs=1e-4)
        assert reading.orientation == pytest.approx(true.orientation, abs=2e-4)
        assert reading.tracked


def test_times_begin_at_0_and_never_run_back(tmp_path: Path) -> None:
    with fastrak(tmp_path) as device, FastrakSource(fastrak_settings(tmp_path)) as source:
        began, stream = time.monotonic(), iter(source)
        device.play(readings(200))
        got = [next(stream)]
        first = time.monotonic()
        got += gather(stream, ends_with(device))
        ended = time.monotonic()
    assert got[0].time == 0.0
    assert all(b.time > a.time for a, b in pairwise(got))
    assert device.intact[-1][0] - first - LINE <= got[-1].time <= ended - began + LINE


@FORMATS
def test_a_device_that_was_unplugged_goes_on_with_the_right_times_and_the_gap_is_missing(
    tmp_path: Path, form: Any
) -> None:
    first, second = readings(60)[:30], readings(60)[30:]
    away = 0.0

    def clock() -> float:
        return time.monotonic() + away

    settings = fastrak_settings(tmp_path, format=form)
    with fastrak(tmp_path) as device, FastrakSource(settings, clock=clock) as source:
        stream = iter(source)
        device.play(first)
        before = gather(stream, ends_with(device))
        left = time.monotonic()
        for _ in range(2):
            device.unplug()
            away += 50.0
            device.plug()
        device.play(second)
        after = gather(stream, ends_with(device))
        back = time.monotonic()
    assert [place(r) for r in before + after] == [place(r) for r in first + second]
    gap = after[0].time - before[-1].time - away
    assert device.intact[30][0] - left - LINE <= gap <= back - device.intact[29][0] + LINE
    for reading, true in zip(after, second, strict=True):  # in metres still: the device woke up in inches
        assert reading.position == pytest.approx(true.position, abs=1e-4)


def test_a_device_that_was_switched_off_behind_its_adapter_is_set_up_again(tmp_path: Path) -> None:
    shown, now = readings(40), [0.0]
    settings = fastrak_settings(tmp_path, silence=0.2)
    with fastrak(tmp_path) as device, FastrakSource(settings, clock=lambda: now[0]) as source:
        stream = iter(source)
        device.play(shown[:20])
        gather(stream, ends_with(device))
        device.simulator.power_up()
        now[0] += 1.0
        until(lambda: device.simulator.streaming, "it is set up again")
        device.play(shown[20:])
        again = gather(stream, ends_with(device))
    assert [place(r) for r in again] == [place(r) for r in shown[20:]]


@FORMATS
def test_a_device_that_paused_for_long_goes_on(tmp_path: Path, form: Any, caplog: pytest.LogCaptureFixture) -> None:
    shown, now = readings(40), [0.0]
    settings = fastrak_settings(tmp_path, silence=0.1, format=form)
    with fastrak(tmp_path) as device, FastrakSource(settings, clock=lambda: now[0]) as source:
        stream = iter(source)
        device.play(shown[:20])
        before = gather(stream, ends_with(device))
        now[0] += 1.0
        until(lambda: "was silent for 0.1 s" in caplog.text, "the pause is noticed")
        # Records that go out while the driver sets the device up again are missing; so it shows the last one longer.
        device.play([*shown[20:], *[shown[-1]] * 200])
        after = gather(stream, lambda reading: place(reading) == place(shown[-1]))
    spots = [place(reading) for reading in after]
    true = [place(reading) for reading in shown]
    assert [place(reading) for reading in before] == true[:20]
    assert spots == sorted(set(spots))
    assert set(spots) <= set(true[20:])


@pytest.mark.parametrize("unit", ["cm", "in"])
@FORMATS
def test_positions_are_in_metres_in_either_unit(tmp_path: Path, unit: Any, form: Any) -> None:
    with fastrak(tmp_path) as device, FastrakSource(fastrak_settings(tmp_path, unit=unit, format=form)) as source:
        device.play(shown := readings(5))
        got = gather(iter(source), lambda _: device.played.is_set() and len(device.intact) == 5)
    for reading, true in zip(got, shown, strict=False):
        assert reading.position == pytest.approx(true.position, abs=0.0254 * 0.006)


def test_a_device_that_keeps_to_its_own_unit_is_refused(tmp_path: Path) -> None:
    with (
        fastrak(tmp_path, FastrakSimulator(fixed_unit=True)),
        pytest.raises(ClientError, match="asked for cm in binary records, but says that it sends in in binary"),
        FastrakSource(fastrak_settings(tmp_path)),
    ):
        pass


def test_the_hand_is_the_first_of_the_stations_and_the_others_are_off(tmp_path: Path) -> None:
    simulator = FastrakSimulator((1, 2, 3))
    settings = fastrak_settings(tmp_path, stations=(2, 1), hemisphere="-z")
    with fastrak(tmp_path, simulator) as device, FastrakSource(settings) as source:
        device.play(shown := readings(20))
        got = gather(iter(source), lambda reading: round(reading.position[1], 4) == round(shown[-1].position[1], 4))
        assert simulator.active == {1, 2}
        assert simulator.hemispheres == {1: "0,0,-1", 2: "0,0,-1", 3: "1,0,0"}
        assert source.capabilities.rate == 60.0
    assert len(got) == 20
    for reading, true in zip(got, shown, strict=True):
        assert reading.position[0] == pytest.approx(true.position[0] + 0.1, abs=1e-6)


def test_a_polled_device_is_asked_at_its_rate(tmp_path: Path) -> None:
    with fastrak(tmp_path, hold=True) as device, FastrakSource(fastrak_settings(tmp_path, mode="polled")) as source:
        stream = iter(source)
        got = [next(stream) for _ in range(11)]
        assert not device.simulator.streaming
    assert got[-1].time > 8 / 50.0  # never faster; a look that came late is made up for at most once


def test_an_error_of_the_device_says_that_the_pose_is_a_guess(tmp_path: Path) -> None:
    lost = HandReading(0.0, (0.1, 0.0, 0.0), None, (), tracked=False)
    with fastrak(tmp_path) as device, FastrakSource(fastrak_settings(tmp_path)) as source:
        device.play([lost, *readings(1)])
        got = gather(iter(source), ends_with(device))
    assert [reading.tracked for reading in got] == [False, True]


def test_closing_ends_the_iteration_and_quiets_the_device(tmp_path: Path) -> None:
    with fastrak(tmp_path, hold=True) as device, FastrakSource(fastrak_settings(tmp_path)) as source:
        stream = iter(source)
        next(stream)
        source.close()
        source.close()
        assert len(list(stream)) <= 1
        source.__exit__()
        until(lambda: not device.simulator.streaming, "the device is quiet")


def test_a_silent_or_missing_or_taken_device_is_said(tmp_path: Path) -> None:
    settings = fastrak_settings(tmp_path)
    with pytest.raises(ClientError, match="is the device plugged in"), FastrakSource(settings):
        pass
    with glove(tmp_path), Emulator(GloveSimulator(GLOVE), tmp_path / "fastrak", rate=RATE):
        with pytest.raises(ClientError, match="no FASTRAK answers"), FastrakSource(settings):
            pass
        with GloveSource(glove_settings(tmp_path)), pytest.raises(ClientError, match="another program is using"):
            GloveSource(glove_settings(tmp_path)).__enter__()
