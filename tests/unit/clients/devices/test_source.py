from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import pytest

import teachpath_client.devices
from teachpath_client.devices import configure, describe_sources, open_source
from teachpath_client.errors import ClientError
from teachpath_client.synthetic import experiment_1, experiment_2
from tests.unit.clients.devices.readings import calibration


@dataclass(frozen=True)
class Example:
    port: str
    rate: float = 50.0
    stations: tuple[int, ...] = (1,)
    unit: Literal["cm", "in"] = "cm"


def test_the_menu_is_complete() -> None:
    for name in teachpath_client.devices.__all__:
        assert getattr(teachpath_client.devices, name).__doc__


def test_the_sources_of_this_package_are_found_with_a_line_each() -> None:
    described = describe_sources()
    assert {"cyberglove", "fastrak", "hand", "replay", "synthetic"} <= set(described)
    for line in described.values():
        assert len(line) > 20
        assert "\n" not in line
        assert not line.startswith("(")


def test_options_become_settings() -> None:
    example = configure(Example, {"port": "a", "rate": "12.5", "stations": "2,1", "unit": "in"})
    assert example == Example("a", 12.5, (2, 1), "in")
    assert configure(Example, {"port": "a"}) == Example("a")


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({}, "the option my.port is missing; say --option my.port="),
        ({"port": "a", "speed": "1"}, "no option my.speed; there are port, rate"),
        ({"port": "a", "rate": "fast"}, "rate=fast is not usable"),
        ({"port": "a", "stations": "1,x"}, "stations=1,x is not usable"),
        ({"port": "a", "unit": "ft"}, "unit=ft is not one of cm, in"),
    ],
)
def test_an_option_that_is_not_usable_is_said(options: dict[str, str], sentence: str) -> None:
    with pytest.raises(ClientError, match=sentence):
        configure(Example, options, prefix="my.")


@pytest.mark.parametrize(
    ("name", "options", "sentence"),
    [
        ("mouse", {}, "no source named mouse; there are cyberglove, fastrak"),
        ("fastrak", {"port": "a", "stations": "5"}, "has the stations 1 to 4"),
        ("fastrak", {"port": "a", "rate": "500"}, "outside 1 to 120"),
        ("fastrak", {"port": "a", "silence": "0"}, "outside 0.1 to 60"),
        ("fastrak", {"port": "a", "pause": "2"}, "outside 0 to 1"),
        ("fastrak", {"port": "a", "baud": "12345"}, "12345 baud is no speed"),
        ("cyberglove", {"port": "a"}, "make one with teachpath-client glove-calibrate"),
        ("cyberglove", {"port": "a", "rate": "1000"}, "outside 2 to 150"),
        ("cyberglove", {"port": "a", "amplitude": "0"}, "outside 1 to 255"),
        ("cyberglove", {"port": "a", "silence": "100"}, "outside 0.1 to 60"),
        ("hand", {"port": "a"}, "they begin with fastrak. or glove."),
        ("hand", {"glove.port": "a"}, "fastrak.port is missing"),
        ("replay", {"file": "none.mcap"}, "cannot read none.mcap"),
    ],
)
def test_a_source_that_cannot_be_made_is_said(name: str, options: dict[str, str], sentence: str) -> None:
    with pytest.raises(ClientError, match=sentence):
        open_source(name, options)


def test_the_synthetic_source_is_the_synthetic_hand() -> None:
    with open_source("synthetic", {"seed": "3"}) as source:
        assert list(source) == list(experiment_1(3))
        assert (source.capabilities.rate, source.capabilities.sensors) == (50.0, 22)
        assert not source.capabilities.live
    with open_source("synthetic", {"experiment": "2"}) as source:
        stream = iter(source)
        assert next(stream) == next(experiment_2(1))
        source.close()
        assert list(stream) == []


def test_a_hand_takes_the_options_of_both_devices(tmp_path: Path) -> None:
    calibration(18).save(tmp_path / "glove.toml")
    options = {"fastrak.port": "a", "fastrak.unit": "in", "glove.port": "b", "glove.touch": "phase"}
    source = open_source("hand", {**options, "glove.calibration": str(tmp_path / "glove.toml")})
    assert source.capabilities.live
    assert source.capabilities.touch
    assert (source.capabilities.rate, source.capabilities.sensors) == (120.0, 18)
