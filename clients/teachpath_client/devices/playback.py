"""Sources without a device: the paper's synthetic hand, and recordings played again."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, Self

from teachpath_client.devices.source import Capabilities, configure
from teachpath_client.errors import ClientError
from teachpath_client.reading import HandReading
from teachpath_client.replay import read_mcap
from teachpath_client.synthetic import RATE, SENSORS, experiment_1, experiment_2


@dataclass(frozen=True)
class SyntheticSettings:
    """Which experiment the synthetic hand shows."""

    # of the paper
    experiment: Literal["1", "2"] = "1"
    # same seed, same hand
    seed: int = 1


@dataclass(frozen=True)
class ReplaySettings:
    """Which recording is played."""

    # MCAP file of a demonstration
    file: str


def synthetic(**options: str) -> PlaybackSource:
    """The paper's two experiments with a synthetic hand; experiment=1|2, seed=NUMBER."""
    settings = configure(SyntheticSettings, options)
    show = experiment_1 if settings.experiment == "1" else experiment_2
    return PlaybackSource(list(show(settings.seed)), rate=RATE, sensors=SENSORS)


def replay(**options: str) -> PlaybackSource:
    """A recorded demonstration with its original timing; file=FILE.mcap."""
    file = Path(configure(ReplaySettings, options).file)
    try:
        readings = read_mcap(file.read_bytes())
    except OSError as error:
        raise ClientError(f"cannot read {file}: {error.strerror}") from error
    duration = readings[-1].time - readings[0].time
    rate = (len(readings) - 1) / duration if duration > 0 else 0.0
    return PlaybackSource(readings, rate=rate, sensors=len(readings[0].flexions))


class PlaybackSource:
    """Readings that are known from the start."""

    def __init__(self, readings: Sequence[HandReading], *, rate: float, sensors: int) -> None:
        self._readings, self._rate, self._sensors = readings, rate, sensors
        self._over = False

    @property
    def capabilities(self) -> Capabilities:
        """What the readings hold."""
        oriented = all(reading.orientation is not None for reading in self._readings)
        return Capabilities(rate=self._rate, sensors=self._sensors, orientation=oriented, live=False)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End the iteration with the next reading."""
        self._over = True

    def __iter__(self) -> Iterator[HandReading]:
        for reading in self._readings:
            if self._over:
                return
            yield reading
