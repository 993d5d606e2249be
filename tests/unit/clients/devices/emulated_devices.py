"""Devices on ptys for tests of their drivers, and how their readings are compared with what was shown."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from teachpath_client.devices.cyberglove import GloveSettings
from teachpath_client.devices.emulators import Emulator
from teachpath_client.devices.fastrak import FastrakSettings
from teachpath_client.devices.protocol_simulators import FastrakSimulator, GloveSimulator
from teachpath_client.reading import HandReading
from tests.unit.clients.devices.readings import calibration

RATE = 400.0  # [Hz] of the emulators
GLOVE = calibration()


@contextmanager
def fastrak(folder: Path, simulator: FastrakSimulator | None = None, **emulated: Any) -> Iterator[Emulator]:
    with Emulator(simulator or FastrakSimulator(), folder / "fastrak", rate=RATE, **emulated) as emulator:
        yield emulator


@contextmanager
def glove(folder: Path, simulator: GloveSimulator | None = None, **emulated: Any) -> Iterator[Emulator]:
    GLOVE.save(folder / "glove.toml")
    with Emulator(simulator or GloveSimulator(GLOVE), folder / "glove", rate=RATE, **emulated) as emulator:
        yield emulator


def fastrak_settings(folder: Path, **chosen: Any) -> FastrakSettings:
    return FastrakSettings(str(folder / "fastrak"), pause=0.0, **{"silence": 30.0, **chosen})


def glove_settings(folder: Path, **chosen: Any) -> GloveSettings:
    return GloveSettings(str(folder / "glove"), str(folder / "glove.toml"), **{"silence": 30.0, **chosen})


def place(reading: HandReading) -> tuple[float, ...]:
    """Return the position in whole steps of the coarsest record, 0.1 mm."""
    return tuple(round(value * 1e4) for value in reading.position)


def seen(flexions: tuple[float, ...]) -> tuple[float, ...]:
    """Return the flexions as the glove shows them."""
    return GLOVE.flexions(GLOVE.raw(flexions))


def whole(emulator: Emulator) -> list[tuple[float, ...]]:
    return [place(reading) for _, reading in emulator.intact]


def ends_with(emulator: Emulator) -> Any:
    """Tell when the last whole record of an emulator that has played all was read."""
    return lambda reading: emulator.played.is_set() and place(reading) == place(emulator.intact[-1][1])
