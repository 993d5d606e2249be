"""The settings of learning, with their limits."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from math import isfinite
from typing import Annotated, Any, get_args, get_type_hints

from annotated_types import Ge, Gt, Le

from teachpath.errors import UnusableSettings
from teachpath.records import LearningMode

MODES = get_args(LearningMode)
METRICS = ("arc", "frechet", "dtw", "undersampled")

Progress = Callable[[float, str], None]
StepCallback = Callable[[], None]  # called after each step of the work; it may raise to cancel the work


def no_progress(_fraction: float, _sentence: str) -> None:
    """Ignore progress."""


@dataclass(frozen=True)
class Subprogress:
    """The progress of a part of the work, which goes from `begin` to `end` of the whole."""

    progress: Progress
    begin: float
    end: float

    def __call__(self, fraction: float, sentence: str) -> None:
        """Report the fraction done of the part."""
        self.progress(self.begin + fraction * (self.end - self.begin), sentence)


@dataclass
class StepCounter:
    """The progress of work in `total` steps, reported with one sentence."""

    progress: Progress
    total: int
    sentence: str
    done: int = 0

    def __call__(self) -> None:
        """Report one more step done."""
        self.done += 1
        self.progress(min(self.done / max(self.total, 1), 1.0), self.sentence)


@dataclass(frozen=True, slots=True, kw_only=True)
class LearningSettings:
    """How paths are learned from demonstrations.

    Raises:
        UnusableSettings: a value is outside its limits, or the mode needs a setting that is missing.
    """

    # `default` is what to trust; `paper` follows Aleotti & Caselli 2005 to the letter; `repaired` is `paper` with
    # symbols in an order that means something and a model that starts from slices of time
    mode: LearningMode = "default"
    # demonstrations that a cluster keeps: at least so many in mode default, exactly so many in the others
    keep: Annotated[int, Ge(1)] = 2
    # distance of two demonstrations in mode default: mean of corresponding points at equal arc length `arc`,
    # `frechet` (discrete), `dtw`, or as in the others, of randomly undersampled points, `undersampled`
    metric: str = "arc"
    # m, clusters farther apart than this stay apart; None = found by `min_separation` (mode default only)
    threshold: Annotated[float, Gt(0)] | None = None
    # number of clusters where it is known, goes before `threshold`; None = found (mode default only)
    clusters: Annotated[int, Ge(1)] | None = None
    # least distance of two clusters, as a multiple of the scatter within clusters (mode default)
    min_separation: Annotated[float, Ge(1), Le(100)] = 2.0
    # robust z above which a demonstration is inconsistent with its cluster (mode default)
    outlier_limit: Annotated[float, Gt(0)] = 3.0
    # repetitions that a demonstration's stability is counted in: other seeds, in mode default others left out
    repeats: Annotated[int, Ge(0), Le(10_000)] = 8
    # m, largest distance of the learned path from what it is fitted to
    error_bound: Annotated[float, Gt(0)] = 0.005
    # the same as a share of the size of the path, where that is less and noise allows it (mode default)
    relative_bound: Annotated[float, Gt(0), Le(1)] = 0.01
    # rad, largest angle of the learned orientations from what they are fitted to
    turn_bound: Annotated[float, Gt(0), Le(1)] = 0.035
    # degree of the NURBS; None = 5 where it costs few control points, else 3
    degree: Annotated[int, Ge(2), Le(7)] | None = None
    # control points a learned path may have at most
    most_control_points: Annotated[int, Ge(8), Le(1000)] = 60
    # of all random choices
    seed: Annotated[int, Ge(0)] = 1
    # states Q of the hidden Markov models (mode paper; repaired has 5)
    states: Annotated[int, Ge(1), Le(100)] = 10
    # Gaussians M per state (mode paper; repaired has 1)
    mixtures: Annotated[int, Ge(1), Le(20)] = 2
    # codewords L per axis (modes paper and repaired)
    codebook: Annotated[int, Ge(2), Le(4096)] = 64

    def __post_init__(self) -> None:
        for name, choices in (("mode", MODES), ("metric", METRICS)):
            if getattr(self, name) not in choices:
                raise UnusableSettings(f"learning.{name} is {getattr(self, name)!r}; it is one of {', '.join(choices)}")
        if self.mode != "default" and self.threshold is None:
            raise UnusableSettings(
                f"learning.mode {self.mode!r} cuts the clusters at a constant distance; "
                "set learning.threshold in metres"
            )
        hints = get_type_hints(type(self), include_extras=True)
        for field in fields(self):
            _check(field.name, getattr(self, field.name), hints[field.name])

    def bound_for(self, size: float) -> float:
        """Return the largest distance [m] that a path of this size [m] may have from what it is fitted to."""
        return min(self.error_bound, self.relative_bound * size) if self.mode == "default" else self.error_bound


def settings_of_run(stored: Mapping[str, Any]) -> LearningSettings:
    """Return the settings that are stored with a run, without those that have been replaced since."""
    known = {field.name for field in fields(LearningSettings)}
    return LearningSettings(**{name: value for name, value in stored.items() if name in known})


def _check(name: str, value: object, hint: object) -> None:
    options = (hint, *get_args(hint))
    limits = next((option.__metadata__ for option in options if hasattr(option, "__metadata__")), ())
    if not limits or (value is None and type(None) in options):
        return
    whole = any(get_args(option)[:1] == (int,) for option in options)
    if isinstance(value, bool) or not isinstance(value, int if whole else (int, float)):
        raise UnusableSettings(f"learning.{name} is {value!r}; it is a {'whole number' if whole else 'number'}")
    if not isfinite(value):
        raise UnusableSettings(f"learning.{name} is {value}; it is a finite number")
    for limit in limits:
        kept, words = _holds(limit, float(value))
        if not kept:
            raise UnusableSettings(f"learning.{name} is {value:g}; it is {words}")


def _holds(limit: object, value: float) -> tuple[bool, str]:
    match limit:
        case Gt(gt=bound):
            return bool(value > bound), f"greater than {bound}"  # type: ignore[operator]
        case Ge(ge=bound):
            return bool(value >= bound), f"at least {bound}"  # type: ignore[operator]
        case Le(le=bound):
            return bool(value <= bound), f"at most {bound}"  # type: ignore[operator]
    raise AssertionError(f"no words for the limit {limit}")
