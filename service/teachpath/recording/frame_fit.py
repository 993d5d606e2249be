"""Calibration of a tracker's frame from taught points: the least-squares mapping to the world and its residuals.

Umeyama, "Least-squares estimation of transformation parameters between two point patterns", IEEE PAMI 13(4), 1991;
with the scale fixed at 1 it is the problem of Horn 1987.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from teachpath.errors import UnusableInput
from teachpath.records import Array, Calibration, MeasuredCalibration, TaughtPoint

MIN_POINTS = 3  # points that fix a frame
MAX_COORDINATE = 100.0  # [m] of a taught point; beyond it the units are wrong
MIN_SPREAD = 0.02  # [m] rms distance of the points from the line that fits them best
MIN_SPREAD_RATIO = 0.05  # least ratio of that spread to the spread along the line
MAX_SCALE_DEVIATION = 0.05  # by which a fitted scale may differ from 1 before the units are doubted


@dataclass(frozen=True, eq=False)
class _Fit:
    """The least-squares mapping between two point sets: world = scale * rotation tracker + offset."""

    rotation: Array
    scale: float
    offset: Array
    residuals: Array


def fit_frame(
    name: str, points: Sequence[TaughtPoint], *, largest_residual: float, fit_scale: bool = False
) -> MeasuredCalibration:
    """Return the calibration that maps the points to the world with the least sum of squares.

    Args:
        name: of the calibration.
        points: in the tracker's frame and in the world [m], three or more that do not lie on one line.
        largest_residual: [m] how far a point may lie from where the mapping puts it.
        fit_scale: fit the scale too; otherwise it is 1, as for every tracker that measures in metres.

    Raises:
        UnusableInput: too few points, points on one line, wrong units, or points that contradict one another.
    """
    if len(points) < MIN_POINTS:
        raise UnusableInput(f"{len(points)} points do not fix a frame; teach {MIN_POINTS} or more, not on one line")
    tracker, world = np.array([p.tracker for p in points]), np.array([p.world for p in points])
    _check(world, "in the world")
    _check(tracker, "for the tracker")
    fit = _fit(tracker, world, fit_scale=fit_scale)
    if not fit_scale:
        _check_units(tracker, world, largest_residual)
    if fit.residuals.max() > largest_residual:
        raise UnusableInput(_contradiction(tracker, world, fit, largest_residual, fit_scale))
    w, x, y, z = Rotation.from_matrix(fit.rotation).as_quat(canonical=True, scalar_first=True).tolist()
    a, b, c = fit.offset.tolist()
    taught = tuple(TaughtPoint(p.tracker, p.world, float(r)) for p, r in zip(points, fit.residuals, strict=True))
    rms = float(np.sqrt(np.mean(fit.residuals**2)))
    return MeasuredCalibration(Calibration(name, fit.scale, (w, x, y, z), (a, b, c)), points=taught, rms=rms)


def _check(places: Array, where: str) -> None:
    if not np.all(np.isfinite(places)) or np.max(np.abs(places)) > MAX_COORDINATE:
        number = int(np.argmax(~np.isfinite(places).all(axis=1) | (np.abs(places) > MAX_COORDINATE).any(axis=1)))
        raise UnusableInput(f"point {number + 1} lies at {places[number].tolist()} m {where}, limit {MAX_COORDINATE:g}")
    _, spreads, _ = np.linalg.svd((places - places.mean(axis=0)) / np.sqrt(len(places)))
    least = max(MIN_SPREAD, MIN_SPREAD_RATIO * spreads[0]) if where == "in the world" else MIN_SPREAD_RATIO * spreads[0]
    if spreads[1] <= least:
        raise UnusableInput(
            f"the points lie on one line {where}: they spread {100 * spreads[0]:.3g} cm along it and "
            f"{100 * spreads[1]:.2g} cm across, {100 * least:.2g} cm are needed; teach one well aside of it"
        )


def _check_units(tracker: Array, world: Array, largest_residual: float) -> None:
    scaled = _fit(tracker, world, fit_scale=True)
    if abs(scaled.scale - 1.0) > MAX_SCALE_DEVIATION and scaled.residuals.max() <= largest_residual:
        raise UnusableInput(
            f"the points lie {scaled.scale:.3g} times as far apart in the world as for the tracker; does it measure in "
            "another unit? A device with a scale of its own needs fit_scale"
        )


def _fit(tracker: Array, world: Array, *, fit_scale: bool, mirrored: bool = False) -> _Fit:
    """Fit the mapping by the singular values of the covariance (Umeyama 1991, equations 34 to 43)."""
    x, y = tracker - tracker.mean(axis=0), world - world.mean(axis=0)
    u, d, vt = np.linalg.svd(y.T @ x / len(x))
    signs = np.array([1.0, 1.0, np.sign(np.linalg.det(u) * np.linalg.det(vt)) * (-1.0 if mirrored else 1.0)])
    rotation = u @ np.diag(signs) @ vt
    scale = float(np.sum(d * signs) / np.mean(np.sum(x**2, axis=1))) if fit_scale else 1.0
    residuals = np.linalg.norm(y - scale * x @ rotation.T, axis=1)
    offset = world.mean(axis=0) - scale * rotation @ tracker.mean(axis=0)
    return _Fit(rotation, scale, offset, residuals)


def _contradiction(tracker: Array, world: Array, fit: _Fit, limit: float, fit_scale: bool) -> str:
    """Say which point contradicts the others, as far as that can be told."""
    worst = int(np.argmax(fit.residuals))
    said = (
        f"the points contradict one another: point {worst + 1} lies {100 * fit.residuals[worst]:.3g} cm from where the "
        f"others put it, limit {100 * limit:.3g} cm"
    )
    if _fit(tracker, world, fit_scale=fit_scale, mirrored=True).residuals.max() <= limit:
        return f"{said}; mirrored they agree: is one axis of the tracker reversed, or its frame left-handed?"
    for k in range(len(tracker)) if len(tracker) > MIN_POINTS else ():
        kept = np.arange(len(tracker)) != k
        if _fit(tracker[kept], world[kept], fit_scale=fit_scale).residuals.max() <= limit:
            return f"{said}; without point {k + 1} they agree: teach that one again"
    return f"{said}; teach them again, each held still"
