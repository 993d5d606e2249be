"""What an operator says of an arm beside its model: a file limits.toml.

speed = 1.5                     # [rad/s] of every joint, or a list with one value a joint
acceleration = [4, 4, 4, 8, 8, 8]
[joints.wrist_3_joint]          # of one joint, by its name in the model
lower = -3.14                   # [rad]
upper = 3.14
[payload]
mass = 0.3                      # [kg]
center = [0.0, 0.0, 0.05]       # [m] in the tool's frame
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

from teachpath.errors import UnusableInput
from teachpath.records import Vector

POSITIVE: Final = ("speed", "acceleration", "jerk", "torque")
ANGLES: Final = ("lower", "upper")
MAX_PAYLOAD: Final = 500.0  # [kg]
MAX_OFFSET: Final = 2.0  # [m] of the payload's centre


@dataclass(frozen=True)
class OperatorLimits:
    """Limits by joint and kind (`lower`, `upper`, `speed`, `acceleration`, `jerk`, `torque`), and the payload."""

    joints: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    payload_mass: float = 0.0
    payload_center: Vector = (0.0, 0.0, 0.0)


def read_limits(path: Path | None, joints: Sequence[str]) -> OperatorLimits:
    """Read what an operator says of the joints of an arm.

    Args:
        path: of the TOML file; None: nothing was said.
        joints: their names in the model, from the base to the tool.

    Raises:
        UnusableInput: the file cannot be read, or a value is none that an arm can have; the sentence names it.
    """
    if path is None:
        return OperatorLimits()
    try:
        said = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise UnusableInput(f"cannot read the limits {path}: {error.strerror}") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise UnusableInput(f"{path} is no TOML: {error}") from None
    _check_names(said, (*POSITIVE, "joints", "payload"), f"{path}")
    limits: dict[str, dict[str, float]] = {name: {} for name in joints}
    for kind in POSITIVE:
        if kind in said:
            for name, value in zip(joints, _one_a_joint(said[kind], len(joints), f"{path}: {kind}"), strict=True):
                limits[name][kind] = _positive(value, f"{path}: {kind} of {name}")
    own = _table(said.get("joints", {}), f"{path}: joints")
    _check_names(own, tuple(joints), f"{path}: joints")
    for name, values in own.items():
        _check_names(_table(values, f"{path}: joints.{name}"), ANGLES + POSITIVE, f"{path}: joints.{name}")
        for kind, value in values.items():
            read = _number if kind in ANGLES else _positive
            limits[name][kind] = read(value, f"{path}: joints.{name}.{kind}")
    return OperatorLimits(limits, *_payload(_table(said.get("payload", {}), f"{path}: payload"), f"{path}: payload"))


def _payload(said: Mapping[str, Any], where: str) -> tuple[float, Vector]:
    _check_names(said, ("mass", "center"), where)
    mass = _number(said.get("mass", 0.0), f"{where}.mass")
    if not 0.0 <= mass <= MAX_PAYLOAD:
        raise UnusableInput(f"{where}.mass is {mass:g} kg; write 0 to {MAX_PAYLOAD:g}")
    x, y, z = (_number(value, f"{where}.center") for value in _one_a_joint(said.get("center", [0, 0, 0]), 3, where))
    if not max(abs(x), abs(y), abs(z)) <= MAX_OFFSET:
        raise UnusableInput(f"{where}.center is over {MAX_OFFSET:g} m from the tool; write it in metres")
    return (mass, (x, y, z)) if mass else (0.0, (0.0, 0.0, 0.0))


def _check_names(said: Mapping[str, Any], known: Sequence[str], where: str) -> None:
    for name in said:
        if name not in known:
            raise UnusableInput(f"{where}: there is no {name!r}; known: {', '.join(known)}")


def _table(value: Any, where: str) -> Mapping[str, Any]:
    if not isinstance(value, Mapping):
        raise UnusableInput(f"{where} is {value!r}; write a table")
    return value


def _one_a_joint(value: Any, count: int, where: str) -> Sequence[Any]:
    values = value if isinstance(value, list) else [value] * count
    if len(values) != count:
        raise UnusableInput(f"{where} has {len(values)} values; write {count}")
    return values


def _number(value: Any, where: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise UnusableInput(f"{where} is {value!r}; write a number")
    return float(value)


def _positive(value: Any, where: str) -> float:
    if (number := _number(value, where)) <= 0.0:
        raise UnusableInput(f"{where} is {number:g}; write a number above zero")
    return number
