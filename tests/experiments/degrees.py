"""Which degree a learned path should have: control points, bends and jerk along it, and how fast the arm may follow."""

from __future__ import annotations

from collections.abc import Sequence
from statistics import median
from typing import Any

import numpy as np

from teachpath.learning.fitting.nurbs_fit import approximate
from teachpath.learning.fitting.synthesis import best_fit, mean_path
from teachpath.learning.resampling import smoothed
from teachpath.learning.settings import LearningSettings
from teachpath.motion.arm.model import Arm
from teachpath.motion.paths.enumeration import enumerate_candidates
from teachpath.motion.paths.ik_branches import is_usable
from teachpath.motion.paths.tool_path import sample_tool_path
from teachpath.motion.settings import MotionSettings
from teachpath.motion.timing.timed_trajectory import time_joint_path
from teachpath.motion.timing.timing import time_tool_path
from teachpath.nurbs import Curve
from tests.experiments.scenarios import SHAPES, along
from tests.unit.learning import synthetic

ARM = Arm.of_variant()

DEGREES = (3, 4, 5)
RATE = 250.0  # Hz
DENSE_POINTS = 2001
CENTRE = np.array([0.5, 0.0, 0.65])  # m, of the paths, in the midst of the arm's reach
KINDS = ("way", *SHAPES)
MEASURES = (
    ("control_points", "control<br>points", ".1f"),
    ("largest", "largest<br>error [mm]", ".2f"),
    ("curvature", "largest<br>curvature [1/m]", ".1f"),
    ("jerk", "RMS third<br>derivative [1/m²]", ".0f"),
    ("duration", "duration at the<br>arm's limits [s]", ".3f"),
)
Row = dict[str, float]


def degrees_once(name: str, seed: int) -> dict[int, Row] | None:
    """Return for every degree what the curve along the mean of five demonstrations is like; None out of reach.

    All degrees follow the same mean within the same bound.
    """
    shown = along(name, seed)[0] if name in SHAPES else synthetic.experiment_2(seed, wiggle=0.0)
    course = mean_path([smoothed(trajectory) for trajectory in shown.values()])
    course = course[:, [1, 0, 2]] if name in SHAPES else course  # their length across the arm
    course += CENTRE - course.mean(axis=0)
    settings = LearningSettings()
    taken, found = best_fit(course, settings, settings.error_bound).curve.degree, {}
    for degree in DEGREES:
        fit = approximate(course, settings.error_bound, degree=degree, most=settings.most_control_points)
        duration = _duration(fit.curve)
        if duration is None:
            return None
        size = float(len(fit.curve.weights))
        row = {"control_points": size, "largest": 1e3 * fit.largest, "duration": duration}
        found[degree] = row | _bends(fit.curve) | {"taken": float(degree == taken)}
    return found


def _bends(curve: Curve) -> Row:
    """Return the largest curvature, and the RMS third derivative by arc length, which makes jerk at constant speed."""
    u = np.linspace(0.0, 1.0, DENSE_POINTS)
    first, second = curve(u, 1), curve(u, 2)
    speed = np.linalg.norm(first, axis=1)
    curvature = np.linalg.norm(np.cross(first, second), axis=1) / speed**3
    s = np.concatenate([[0.0], np.cumsum((speed[1:] + speed[:-1]) / 2 * np.diff(u))])
    by_length = np.gradient(np.gradient(first / speed[:, None], s, axis=0), s, axis=0)
    third = np.square(by_length).sum(axis=1)
    return {"curvature": float(curvature.max()), "jerk": float(np.sqrt(np.trapezoid(third, s) / s[-1]))}


def _duration(curve: Curve) -> float | None:
    settings = MotionSettings()
    way = sample_tool_path(curve, settings)
    able = [candidate for candidate in enumerate_candidates(way, ARM, settings) if is_usable(candidate, settings)]
    if not able:
        return None
    path, squared_rates = time_tool_path(
        way, max(able, key=lambda c: c.min_singular_value), ARM.limits.motion, rate=RATE
    )
    return float(time_joint_path(path, squared_rates, ARM.limits.motion).duration)


def summary(outcomes: Sequence[tuple[str, dict[int, Row] | None]]) -> dict[str, Any]:
    """Return for every kind of path and degree the medians, how many there are, and in how many it is the fastest."""
    found: dict[str, Any] = {}
    for kind in KINDS:
        paths = [rows for name, rows in outcomes if name == kind and rows is not None]
        fastest = [min(DEGREES, key=lambda degree: rows[degree]["duration"]) for rows in paths]
        found[kind] = {"n": len(paths)} | {
            str(degree): {key: round(median(rows[degree][key] for rows in paths), 4) for key, _, _ in MEASURES}
            | {"fastest": fastest.count(degree), "taken": sum(int(rows[degree]["taken"]) for rows in paths)}
            for degree in DEGREES
            if paths
        }
    return found


def table(found: dict[str, Any]) -> str:
    """Return the medians as a table."""
    rows = []
    for kind in KINDS:
        for degree in DEGREES:
            of = found[kind].get(str(degree))
            if of is not None:
                cells = "".join(f"<td>{of[key]:{form}}" for key, _, form in MEASURES)
                counts = f"<td>{of['fastest']}<td>{of['taken']}<td>{found[kind]['n']}"
                rows.append(f"<tr><td class=l>{kind}<td>{degree}{cells}{counts}")
    heads = "".join(f"<th>{head}" for _, head, _ in MEASURES)
    heads += "<th>fastest<th>taken by<br>mode default<th>of"
    return (
        "<table><caption><b>Table VI.</b> The same means followed within the same bound by curves of three degrees; "
        "medians over data sets, of those within the arm's reach. Durations are those of the planner's own timing, "
        "from rest to rest on one branch of the arm, within all limits of speed, acceleration and "
        f"jerk.</caption><tr><th class=l>Path<th>degree{heads}{''.join(rows)}</table>"
    )
