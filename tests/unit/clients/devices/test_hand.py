"""Tracker and glove as one hand: every pose once, with the flexions measured last before it."""

from collections import deque
from itertools import accumulate, pairwise
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from teachpath_client.devices.fastrak import FastrakSource
from teachpath_client.devices.hand import HandSource, Pairing
from teachpath_client.errors import ClientError
from teachpath_client.reading import HandReading
from tests.unit.clients.devices.emulated_devices import (
    GLOVE,
    RATE,
    fastrak,
    fastrak_settings,
    glove,
    glove_settings,
    place,
    seen,
)
from tests.unit.clients.devices.readings import gather, readings, until


def is_same(reading: HandReading, shown: HandReading) -> bool:
    return place(reading) == place(shown) and reading.flexions == pytest.approx(seen(shown.flexions))


def test_a_hand_has_every_pose_once_with_the_whole_flexions_of_one_moment(tmp_path: Path) -> None:
    shown = readings(150)
    with fastrak(tmp_path, hold=True) as tracker, glove(tmp_path, hold=True) as gloved:
        with HandSource(fastrak_settings(tmp_path), glove_settings(tmp_path)) as source:
            stream = iter(source)
            for device in (tracker, gloved):
                device.show(shown[0])
            gather(stream, lambda reading: is_same(reading, shown[0]))  # what they showed before has passed
            for device in (tracker, gloved):
                device.play(shown)
            got = gather(stream, lambda reading: place(reading) == place(shown[-1]))
        assert source.capabilities.sensors == 22
    index = {place(reading): i for i, reading in enumerate(shown)}
    moved = [reading for reading in got if place(reading) != place(shown[0])]
    numbers = [index[place(reading)] for reading in moved]
    assert numbers == sorted(set(numbers))  # where the machine is too busy, the line or the glove leaves some out
    assert numbers[-1] == len(shown) - 1
    moment = 0
    for reading in moved:  # each has the flexions of one moment, unmixed, and time never goes back
        same = [k for k, r in enumerate(shown) if reading.flexions == pytest.approx(seen(r.flexions))]
        assert [k for k in same if k >= moment], f"the flexions go back before moment {moment}"
        moment = min(k for k in same if k >= moment)


def test_half_a_hand_gives_no_reading(tmp_path: Path) -> None:
    shown = readings(2)
    with (
        fastrak(tmp_path, hold=True) as tracker,
        glove(tmp_path, hold=True) as gloved,
        HandSource(fastrak_settings(tmp_path), glove_settings(tmp_path)) as source,
    ):
        stream = iter(source)
        for device in (tracker, gloved):
            device.show(shown[0])
        next(stream)
        gloved.unplug()
        tracker.show(shown[1])
        gone = len(tracker.intact)
        until(lambda: len(tracker.intact) > gone + RATE / 4, "the tracker goes on alone")
        gloved.plug()
        gloved.show(shown[1])
        got = gather(stream, lambda reading: reading.flexions == pytest.approx(seen(shown[1].flexions)))
    alone = max(b.time - a.time for a, b in pairwise(got))
    assert alone > 0.1


def test_a_hand_opens_both_devices_or_none(tmp_path: Path) -> None:
    with fastrak(tmp_path, hold=True) as device:
        GLOVE.save(tmp_path / "glove.toml")
        with pytest.raises(ClientError, match="glove as a serial line"):
            HandSource(fastrak_settings(tmp_path), glove_settings(tmp_path)).__enter__()
        until(lambda: not device.simulator.streaming, "the tracker is quiet")
        with FastrakSource(fastrak_settings(tmp_path)) as source:
            assert next(iter(source)).time == 0.0


# how closely pose and flexions are paired


def glove_reading(number: int) -> HandReading:
    return HandReading(0.0, (0.0, 0.0, 0.0), None, (float(number),), tracked=False)


@given(
    gloved=st.lists(st.tuples(st.floats(0.001, 0.05), st.floats(0.0, 0.02)), max_size=60),
    poses=st.lists(st.floats(0.0, 0.06), min_size=1, max_size=60),
    oldest=st.sampled_from([0.03, 0.1]),
)
def test_a_pose_has_the_last_flexions_before_it_that_have_arrived_and_none_that_are_too_old(
    gloved: list[tuple[float, float]], poses: list[float], oldest: float
) -> None:
    dates = list(accumulate(step for step, _ in gloved))
    arrivals = list(accumulate((date + late for date, (_, late) in zip(dates, gloved, strict=True)), max))
    waiting = deque(enumerate(dates))
    now = 0.0

    def take() -> tuple[float, HandReading] | None:
        if not waiting or arrivals[waiting[0][0]] > now:
            return None
        number, date = waiting.popleft()
        return date, glove_reading(number)

    pairing = Pairing(take, oldest)
    for step in poses:
        now += step
        there = [k for k, date in enumerate(dates) if date <= now and arrivals[k] <= now]
        wanted = there[-1] if there and now - dates[there[-1]] <= oldest else None
        assert pairing.flexions_at(now) == (None if wanted is None else (float(wanted),))


def test_the_flexions_of_a_pose_are_at_most_a_period_of_the_glove_old() -> None:
    waiting = deque((k / 100.0, glove_reading(k)) for k in range(1000))
    pairing = Pairing(lambda: waiting.popleft() if waiting else None, 0.1)
    for k in range(1, 500):
        pose = k / 50.0 - 0.003
        flexions = pairing.flexions_at(pose)
        assert flexions is not None
        assert 0.0 <= pose - flexions[0] / 100.0 < 0.01
