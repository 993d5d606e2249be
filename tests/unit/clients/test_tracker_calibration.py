"""Measuring a tracker's frame: what is held still counts, what moved is asked for again."""

import re
from dataclasses import replace
from pathlib import Path
from typing import Self

import pytest

from teachpath_client.__main__ import main
from teachpath_client.devices.emulators import Emulator
from teachpath_client.devices.fastrak import FastrakSettings, FastrakSource
from teachpath_client.devices.playback import PlaybackSource
from teachpath_client.devices.protocol_simulators import FastrakSimulator
from teachpath_client.errors import ClientError
from teachpath_client.models import Calibration, MeasuredCalibration, TaughtPoint
from teachpath_client.reading import HandReading, Vector
from teachpath_client.tracker_calibration import Pair, lines, measure_points, read_points

PLACES: list[Vector] = [(0.4, -0.3, 0.5), (0.7, -0.3, 0.5), (0.7, 0.3, 0.5)]
HEADER = "tracker_x,tracker_y,tracker_z,x,y,z\n"


def at(place: Vector, *, tracked: bool = True) -> HandReading:
    return HandReading(0.0, place, (1.0, 0.0, 0.0, 0.0), tracked=tracked)


def test_each_point_is_where_the_tracker_was_held_still_after_it_was_told(tmp_path: Path) -> None:
    told: list[str] = []
    with Emulator(FastrakSimulator(), tmp_path / "port", rate=100.0, hold=True) as device:
        held = iter([(0.1, 0.0, 0.0), (0.2, 0.1, 0.0), (0.3, 0.0, 0.2)])

        def tell(sentence: str) -> None:
            told.append(sentence)
            if "again" in sentence:  # the first time at point 2 it was lost
                device.show(at((0.2, 0.1, 0.0)))
                return
            device.show(at(next(held), tracked="point 2" not in sentence))

        settings = FastrakSettings(str(tmp_path / "port"), pause=0.0)
        pairs = measure_points(lambda: FastrakSource(settings), PLACES, tell, held=0.1)
    assert [pair.world for pair in pairs] == PLACES
    for pair, true in zip(pairs, [(0.1, 0.0, 0.0), (0.2, 0.1, 0.0), (0.3, 0.0, 0.2)], strict=True):
        assert pair.tracker == pytest.approx(true, abs=1e-3)
    assert [re.sub(r"\d+ of \d+ readings", "n readings", sentence)[:30] for sentence in told] == [
        "point 1 of 3: hold the tracker",
        "point 2 of 3: hold the tracker",
        "n readings were not tracked; a",
        "point 3 of 3: hold the tracker",
    ]


def still(place: Vector, count: int = 60) -> list[HandReading]:
    return [replace(at(place), time=0.02 * i) for i in range(count)]


class Shown:
    """Gives, each time it is connected, the readings that come next."""

    def __init__(self, *shown: list[HandReading] | ClientError) -> None:
        self._shown = iter([[], *shown])  # the first time it is only asked whether it is there

    def __call__(self) -> PlaybackSource:
        return Sometimes(next(self._shown))


class Sometimes(PlaybackSource):
    def __init__(self, shown: list[HandReading] | ClientError) -> None:
        self._gone = shown if isinstance(shown, ClientError) else None
        super().__init__([] if isinstance(shown, ClientError) else shown, rate=50.0, sensors=0)

    def __enter__(self) -> Self:
        if self._gone is not None:
            raise self._gone
        return self


def test_a_tracker_that_moves_or_is_unplugged_is_asked_for_again() -> None:
    moving = [replace(at((0.0004 * i, 0.0, 0.0)), time=0.02 * i) for i in range(60)]
    make = Shown(moving, ClientError("it is gone"), still((0.1, 0.0, 0.0)))
    told: list[str] = []
    (pair,) = measure_points(make, PLACES[:1], told.append)
    assert re.match(r"it moved by 1\d mm, 5 mm are allowed; again, point 1 of 1", told[1])
    assert told[2].startswith("it is gone; again, point 1 of 1")
    assert pair.tracker == pytest.approx((0.1, 0.0, 0.0))


def test_how_long_it_is_held_is_told_by_its_own_clock() -> None:
    readings = still((0.1, 0.0, 0.0)) + still((9.0, 0.0, 0.0))
    (pair,) = measure_points(Shown(readings), PLACES[:1], lambda _: None)
    assert pair.tracker == pytest.approx((0.1, 0.0, 0.0))


def test_a_device_that_does_not_answer_is_said_before_anybody_walks() -> None:
    told: list[str] = []
    with pytest.raises(ClientError, match="nothing there"):
        measure_points(lambda: Sometimes(ClientError("nothing there")), PLACES, told.append)
    assert told == []


def test_a_source_that_ends_is_said() -> None:
    with pytest.raises(ClientError, match="only 1 readings came"):
        measure_points(Shown([at((0.0, 0.0, 0.0))]), PLACES, lambda _: None)


def test_points_come_from_a_file(tmp_path: Path) -> None:
    file = tmp_path / "points.csv"
    file.write_text(HEADER + "1,2,3,4,5,6\n")
    assert read_points(file) == [Pair((1.0, 2.0, 3.0), (4.0, 5.0, 6.0))]
    for text, sentence in (
        (HEADER + "1,2,3,4,5\n", "line 2: 1,2,3,4,5 is not six numbers"),
        ("x,y\n", "the first line must be tracker_x"),
        ("", "the first line must be"),
    ):
        file.write_text(text)
        with pytest.raises(ClientError, match=sentence):
            read_points(file)
    with pytest.raises(ClientError, match="cannot read"):
        read_points(tmp_path / "none.csv")


def test_the_operator_sees_the_residuals_and_a_piece_of_a_settings_file() -> None:
    points = [TaughtPoint((0.0, 0.0, 0.0), place, 0.0012) for place in PLACES]
    calibration = Calibration("lab", 1.0, (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.5))
    said = list(lines(MeasuredCalibration(calibration, 3, points, 0.0012)))
    assert said[0] == "point 1 at 0.4, -0.3, 0.5 m: 1.2 mm off"
    assert said[3] == "lab: 1.20 mm rms over 3 points; version 3 is kept"
    assert said[-4:] == ['name = "lab"', "scale = 1.0", "rotation = [1.0, 0.0, 0.0, 0.0]", "offset = [0.0, 0.0, 0.5]"]


@pytest.mark.parametrize(
    "arguments",
    [[], ["--point", "0,0,0"], ["--source", "synthetic"], ["--points", "x.csv", "--source", "a", "--point", "0,0,0"]],
)
def test_either_a_device_or_a_file(arguments: list[str]) -> None:
    with pytest.raises(SystemExit, match="name a --source and each --point, or a file"):
        main(["tracker-calibrate", "lab", *arguments])
