"""Trajectories from what a program has: arrays, lists of rows, and tables with named columns."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from teachpath.errors import UnusableInput
from teachpath.records import Array, Trajectory

DEFAULT_DT: Final = 0.02  # [s] between two samples of which no times are known: 50 Hz, as in the paper
MAX_COORDINATE: Final = 10.0  # [m] of a position; farther from the robot is a wrong unit
MAX_DURATION: Final = 3600.0  # [s] of one demonstration; longer is a wrong unit
UNIT_TOLERANCE: Final = 0.01  # by how much the length of a quaternion may differ from 1
POSITION: Final = ("x", "y", "z")
QUATERNION: Final = ("qw", "qx", "qy", "qz")
TIME: Final = ("t", "time", "times")


@dataclass(frozen=True)
class _Samples:
    """What was given as one demonstration: an array (n, k), times if they came with it, and how errors name it."""

    name: str
    values: Array
    times: Array | None


def to_trajectories(
    demonstrations: Mapping[str, Any] | Iterable[Any], *, times: Any = None, dt: float | None = None
) -> dict[str, Trajectory]:
    """Return demonstrations as trajectories by name; those of a list are named by their numbers from 1.

    Args:
        demonstrations: each as `to_trajectory` takes it.
        times: of each demonstration (n,) [s], in the same order or under the same names.
        dt: time between two samples [s].

    Raises:
        UnusableInput: there is none, or one cannot be used; the sentence names it.
    """
    given = dict(demonstrations) if isinstance(demonstrations, Mapping) else _numbered(demonstrations)
    if times is None:
        known = dict.fromkeys(given)
    else:
        known = dict(times) if isinstance(times, Mapping) else _numbered(times)
        if known.keys() != given.keys():
            raise UnusableInput(
                f"times of {_listed(known)} do not belong to the demonstrations {_listed(given)}; give one array each"
            )
    return {name: to_trajectory(one, name, times=known[name], dt=dt) for name, one in given.items()}


def to_trajectory(
    given: Any, name: str = "1", *, times: ArrayLike | None = None, dt: float | None = None
) -> Trajectory:
    """Return one demonstration as a trajectory that starts at time 0.

    Args:
        given: a Trajectory; an array or rows (n, 3) of x, y, z [m] in the world, or (n, 7) with a unit quaternion
            w, x, y, z; or a table (anything with `columns`, or a mapping) with the columns x, y, z, and perhaps
            qw, qx, qy, qz and t.
        name: of the demonstration, for errors.
        times: (n,) [s], increasing; they may start anywhere.
        dt: time between two samples [s] instead; 0.02 when there are no times at all.

    Raises:
        UnusableInput: wrong shape, unit, order or values; says which value, the limit, where, and what to do.
    """
    samples = _samples(given, f"demonstration {name}")
    if times is not None:
        if samples.times is not None:
            raise UnusableInput(f"{samples.name} has times of its own; leave out those beside it")
        samples = _Samples(samples.name, samples.values, _numbers(times, f"the times of {samples.name}"))
    positions, orientations = _positions(samples), _orientations(samples)
    return Trajectory(_times(samples, dt), positions, orientations)


def _numbered(given: Any) -> dict[str, Any]:
    if (
        _columns(given) is not None
        or (isinstance(given, np.ndarray) and given.ndim < 3)
        or isinstance(given, Trajectory)
    ):
        raise UnusableInput(f"a list of demonstrations is needed, this is one ({type(given).__name__}); write [it]")
    try:
        return {str(number): one for number, one in enumerate(given, 1)}
    except TypeError:
        raise UnusableInput(f"a list of demonstrations is needed, not {type(given).__name__}") from None


def _samples(given: Any, name: str) -> _Samples:
    if isinstance(given, Trajectory):
        values = _numbers(given.positions, name)
        if given.orientations is not None:
            values = np.concatenate([values, _numbers(given.orientations, name)], axis=-1)
        return _Samples(name, values, _numbers(given.times, f"the times of {name}"))
    columns = _columns(given)
    if columns is None:
        return _Samples(name, _numbers(given, name), None)
    wanted = POSITION + (QUATERNION if set(QUATERNION) & set(columns) else ())
    if missing := [column for column in wanted if column not in columns]:
        raise UnusableInput(
            f"{name} has no column {missing[0]}; it has {_listed(columns)}, and needs x, y, z [m], perhaps with "
            "qw, qx, qy, qz and t [s]"
        )
    values = np.column_stack([_numbers(given[column], f"{name}, column {column}") for column in wanted])
    time = next((column for column in TIME if column in columns), None)
    return _Samples(name, values, None if time is None else _seconds(given[time], f"{name}, column {time}"))


def _columns(given: Any) -> list[str] | None:
    """Return the names of the columns of a table; None when it is none."""
    names = given if isinstance(given, Mapping) else getattr(given, "columns", None)
    return None if names is None else [str(name) for name in names]


def _numbers(given: Any, name: str) -> Array:
    plain = given.to_numpy() if hasattr(given, "to_numpy") else given
    try:
        values = np.asarray(plain)
        if values.dtype.kind not in "biufO":
            raise UnusableInput(f"{name} holds {values.dtype.name} values, e.g. {values.flat[0]!r}; give numbers")
        return np.array(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise UnusableInput(f"{name} is no array of numbers ({error}); give rows of one length") from None


def _seconds(given: Any, name: str) -> Array:
    values = np.asarray(given.to_numpy() if hasattr(given, "to_numpy") else given)
    if values.dtype.kind == "M" and len(values):
        values = values - values[0]
    seconds = values / np.timedelta64(1, "s") if values.dtype.kind == "m" else values
    return _numbers(seconds, name)


def _positions(samples: _Samples) -> Array:
    shape = samples.values.shape
    if len(shape) != 2 or shape[1] not in (3, 7):
        turned = "; transpose it: array.T" if len(shape) == 2 and shape[0] in (3, 7) else ""
        raise UnusableInput(
            f"{samples.name} has the shape {shape}, not (n, 3) of x, y, z [m] or (n, 7) with a quaternion w, x, y, z"
            f"{turned}"
        )
    not_finite = ~np.all(np.isfinite(samples.values), axis=1)
    _refuse_row(samples, not_finite, "is not finite", "leave the row out, with its time")
    positions = samples.values[:, :3]
    far = np.abs(positions).max(axis=1, initial=0.0) > MAX_COORDINATE
    _refuse_row(
        samples, far, f"is farther than {MAX_COORDINATE:g} m from the robot", "give metres: divide millimetres by 1000"
    )
    return positions


def _orientations(samples: _Samples) -> Array | None:
    if samples.values.shape[1] == 3:
        return None
    quaternions = samples.values[:, 3:]
    lengths = np.sqrt(np.sum(quaternions**2, axis=1))
    wrong = np.abs(lengths - 1.0) > UNIT_TOLERANCE
    _refuse_row(samples, wrong, "has a quaternion that is not of length 1", "give w, x, y, z, normalised")
    unit: Array = quaternions / lengths[:, None]
    # q and -q are one orientation: neighbours are brought to one half of the sphere
    opposite = np.sum(unit[1:] * unit[:-1], axis=1) < 0.0
    unit[1:][np.cumsum(opposite) % 2 == 1] *= -1.0
    return unit


def _times(samples: _Samples, dt: float | None) -> Array:
    count = len(samples.values)
    if samples.times is None:
        step = DEFAULT_DT if dt is None else float(dt)
        if not 0.0 < step < MAX_DURATION:
            raise UnusableInput(f"dt is {step:g} s; it is greater than 0 and less than {MAX_DURATION:g}")
        return np.arange(count, dtype=np.float64) * step
    if dt is not None:
        raise UnusableInput(f"{samples.name} has times, and dt = {dt:g} s is given too; leave out one of them")
    times = samples.times
    if times.shape != (count,):
        raise UnusableInput(f"{samples.name} has {count} samples and times of shape {times.shape}; give one a sample")
    steps = np.diff(times, prepend=times[:1] - 1.0)
    _refuse_row(samples, ~(steps > 0.0), "does not come later than the one before", "sort by time, each time once")
    if count and times[-1] - times[0] > MAX_DURATION:
        raise UnusableInput(
            f"{samples.name} lasts {times[-1] - times[0]:g} s, limit {MAX_DURATION:g}; give seconds: divide "
            "milliseconds by 1000"
        )
    return np.asarray(times - times[:1])


def _refuse_row(samples: _Samples, wrong: NDArray[np.bool_], fault: str, way_out: str) -> None:
    if wrong.any():
        row = int(np.argmax(wrong))
        time = "" if samples.times is None else f" at {samples.times[row]:g} s"
        shown = ", ".join(f"{value:g}" for value in samples.values[row])
        raise UnusableInput(f"{samples.name}: row {row} of {len(wrong)}{time} ({shown}) {fault}; {way_out}")


def _listed(names: Collection[str]) -> str:
    return ", ".join(list(names)[:10]) + (", ..." if len(names) > 10 else "") if names else "none"
