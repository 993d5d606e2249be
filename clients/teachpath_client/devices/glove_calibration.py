"""The calibration of a glove: from raw sensor values to flexions from 0 (open hand) to 1 (fist)."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean, median
from typing import Self

from teachpath_client.devices.cyberglove_wire import SENSORS
from teachpath_client.errors import ClientError

MIN_RANGE = 12  # raw steps between open hand and fist; less is noise and creep of the glove
MIN_SENSOR_SHARE = 0.5  # of the sensors that must tell an open hand from a fist


@dataclass(frozen=True)
class GloveCalibration:
    """A gain and an offset for each sensor: flexion = gain (raw - offset), kept within 0 and 1.

    A sensor of gain 0 does not tell an open hand from a fist (wrist, abduction); it is given the mean of the others,
    so that the mean of all flexions stays the closure of the hand.

    Attributes:
        offset: raw value of the open hand, one a sensor.
        gain: flexion for one raw step, one a sensor; negative when the value falls as the hand closes.
    """

    offset: tuple[float, ...]
    gain: tuple[float, ...]

    def __post_init__(self) -> None:
        if len(self.offset) != len(self.gain) or len(self.offset) not in SENSORS:
            raise ClientError(
                f"a glove has 18 or 22 sensors, not {len(self.offset)} offsets and {len(self.gain)} gains"
            )
        if sum(gain != 0.0 for gain in self.gain) < MIN_SENSOR_SHARE * len(self.gain):
            raise ClientError(
                f"only {sum(gain != 0.0 for gain in self.gain)} of {len(self.gain)} sensors tell the open hand from "
                "the fist; was the hand once quite open and once quite closed?"
            )

    @classmethod
    def between(cls, opened: Sequence[Sequence[int]], closed: Sequence[Sequence[int]]) -> Self:
        """Return the calibration between raw samples of an open hand and of a fist."""
        if not opened or not closed:
            raise ClientError("no samples came from the glove; is it plugged in?")
        low = [median(values) for values in zip(*opened, strict=True)]
        high = [median(values) for values in zip(*closed, strict=True)]
        ranges = [b - a for a, b in zip(low, high, strict=True)]
        gains = [1.0 / step if abs(step) >= MIN_RANGE else 0.0 for step in ranges]
        return cls(tuple(map(float, low)), tuple(gains))

    @classmethod
    def load(cls, file: Path) -> Self:
        """Read a file that `save` wrote."""
        try:
            content = tomllib.loads(file.read_text())
            return cls(tuple(map(float, content["offset"])), tuple(map(float, content["gain"])))
        except OSError as error:
            raise ClientError(
                f"cannot read the calibration {file}: {error.strerror}; make one with teachpath-client glove-calibrate"
            ) from None
        except (ValueError, KeyError, TypeError) as error:
            raise ClientError(f"{file} is no calibration of a glove: {error!r}") from None

    def save(self, file: Path) -> None:
        """Write the calibration as TOML."""
        rows = [f"{name} = [{', '.join(map(repr, getattr(self, name)))}]" for name in ("offset", "gain")]
        text = "# Calibration of a glove, one value a sensor: flexion = gain (raw - offset), 0 open, 1 closed.\n"
        try:
            file.write_text(text + "\n".join(rows) + "\n")
        except OSError as error:
            raise ClientError(f"cannot write {file}: {error.strerror}") from None

    def flexions(self, raw: Sequence[int]) -> tuple[float, ...]:
        """Return the flexions of one raw sample, 0 to 1."""
        told = [
            min(1.0, max(0.0, gain * (value - offset))) if gain else None
            for value, offset, gain in zip(raw, self.offset, self.gain, strict=True)
        ]
        mean = fmean(value for value in told if value is not None)
        return tuple(mean if value is None else value for value in told)

    def raw(self, flexions: Sequence[float]) -> tuple[int, ...]:
        """Return the raw sample that a glove with these flexions would send; the inverse of `flexions`."""
        values = (
            offset + (flexion / gain if gain else 0.0)
            for flexion, offset, gain in zip(flexions, self.offset, self.gain, strict=True)
        )
        return tuple(min(255, max(1, round(value))) for value in values)
