"""The paper's two experiments as a seeded hand: reach, grasp, transport, release and return, with tremor and noise.

Aleotti & Caselli 2005, section IV. The hand moves on the minimum-jerk profile of Flash & Hogan 1985; the tremor is
band-limited (6 to 10 Hz).
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from teachpath_client.reading import HandReading

Array = NDArray[np.float64]

RATE = 50.0  # [Hz], "the sampling rate of the tracker was set to 20ms"
SENSORS = 22
START = np.array([0.58, -0.28, 0.52])  # object's centre [m, world]
GOAL = np.array([0.58, 0.28, 0.52])
REST = np.array([0.48, -0.45, 0.72])  # where the hand waits
HAND_ABOVE = np.array([0.0, 0.0, 0.03])  # hand from the object's centre while it holds it

# Where each way passes the obstacles (x at y = 0) and how high it lifts the object [m].
ROUTES = {"near": (0.38, 0.10), "between": (0.58, 0.10), "far": (0.78, 0.10)}

# Table I of the paper: which demonstration went which way.
EXPERIMENT_1 = ("near", "between", "far", "far", "between", "near", "far", "near", "far", "near", "between", "near")


@dataclass(frozen=True)
class SyntheticHand:
    """How steady the synthetic hand is."""

    spread: float = 0.008  # [m] of the way from one demonstration to the next
    tremor: float = 0.0010  # [m] rms an axis
    noise: float = 0.0005  # [m] rms an axis, of the tracker
    transport: float = 3.16  # [s], 159 samples
    duration_spread: float = 0.0  # share by which the transport time varies
    wiggle: float = 0.0  # [m], 1.5 to 3 Hz


def experiment_1(seed: int = 1, hand: SyntheticHand | None = None) -> Iterator[HandReading]:
    """Yield twelve demonstrations of three ways around a box and a cylinder (5, 3 and 4), in the paper's order."""
    hand = hand or SyntheticHand()
    return _session([(way, hand) for way in EXPERIMENT_1], seed)


def experiment_2(seed: int = 1, wiggle: float = 0.025) -> Iterator[HandReading]:
    """Yield five demonstrations of one way; the fifth has strong wiggles."""
    steady, shaky = SyntheticHand(transport=3.98), SyntheticHand(transport=3.98, wiggle=wiggle)
    return _session([("between", steady)] * 4 + [("between", shaky)], seed)


def _session(demonstrations: list[tuple[str, SyntheticHand]], seed: int) -> Iterator[HandReading]:
    random = np.random.default_rng(seed)
    ticks = itertools.count()
    for way, hand in demonstrations:
        positions, closures = _demonstration(way, hand, random)
        positions = positions + _tremor(len(positions), hand.tremor, random)
        positions += random.normal(0.0, hand.noise, positions.shape)
        tilts = _tremor(len(positions), 0.01, random)  # [rad]
        gains = random.uniform(0.9, 1.0, SENSORS)
        for position, closure, tilt in zip(positions, closures, tilts, strict=True):
            flexions = np.clip(0.08 + 0.85 * closure * gains + random.normal(0.0, 0.015, SENSORS), 0.0, 1.0)
            x, y, z = position.tolist()
            yield HandReading(next(ticks) / RATE, (x, y, z), _tilted(tilt), tuple(flexions.tolist()))


def _demonstration(way: str, hand: SyntheticHand, random: np.random.Generator) -> tuple[Array, Array]:
    """Return hand positions (n, 3) and closures (n,), without tremor."""
    transport = hand.transport * (1.0 + random.uniform(-1, 1) * hand.duration_spread)
    pieces = [
        (_still(REST, 0.5), 0.0, 0.0),
        (_straight(REST, START + HAND_ABOVE, 1.0), 0.0, 0.0),
        (_still(START + HAND_ABOVE, 0.3), 0.0, 1.0),
        (_carry(way, hand, transport, random) + HAND_ABOVE, 1.0, 1.0),
        (_still(GOAL + HAND_ABOVE, 0.3), 1.0, 0.0),
        (_straight(GOAL + HAND_ABOVE, REST, 1.2), 0.0, 0.0),
        (_still(REST, 0.6), 0.0, 0.0),
    ]
    closures = [_ramp(before, after, len(points)) for points, before, after in pieces]
    return np.concatenate([points for points, _, _ in pieces]), np.concatenate(closures)


def _carry(way: str, hand: SyntheticHand, duration: float, random: np.random.Generator) -> Array:
    across, lift = ROUTES[way]
    across += random.normal(0.0, hand.spread)
    lift += random.normal(0.0, hand.spread)
    u = _progress(duration)
    bump = 4.0 * u * (1.0 - u)
    bump = bump * (1.0 + 0.3 * random.normal(0.0, 1.0) * hand.spread / 0.02 * (2.0 * u - 1.0))
    way_points = START + np.outer(u, GOAL - START)
    way_points += np.outer(bump, [across - START[0], 0.0, lift])
    if hand.wiggle:
        way_points += _wiggle(len(u), hand.wiggle, random)
    return np.asarray(way_points)


def _progress(duration: float) -> Array:
    t = np.linspace(0.0, 1.0, max(2, round(duration * RATE)))
    return np.asarray(t**3 * (10.0 - 15.0 * t + 6.0 * t**2))


def _straight(start: Array, end: Array, duration: float) -> Array:
    return np.asarray(start + np.outer(_progress(duration), end - start))


def _still(place: Array, duration: float) -> Array:
    return np.tile(place, (round(duration * RATE), 1))


def _ramp(before: float, after: float, count: int) -> Array:
    return np.interp(np.arange(count), [0.25 * count, 0.75 * count], [before, after])


def _tremor(count: int, rms: float, random: np.random.Generator) -> Array:
    """Return (count, 3) noise of 6 to 10 Hz with the given rms an axis."""
    spectrum = np.fft.rfft(random.normal(0.0, 1.0, (count, 3)), axis=0)
    frequency = np.fft.rfftfreq(count, 1.0 / RATE)
    spectrum[(frequency < 6.0) | (frequency > 10.0)] = 0.0
    wave = np.fft.irfft(spectrum, count, axis=0)
    return np.asarray(rms * wave / np.maximum(wave.std(axis=0), 1e-12))


def _wiggle(count: int, amplitude: float, random: np.random.Generator) -> Array:
    t = np.arange(count) / RATE
    fade = np.sin(np.pi * np.arange(count) / (count - 1)) ** 2
    frequency, phase = random.uniform(1.5, 3.0, 3), random.uniform(0.0, 2.0 * np.pi, 3)
    return np.asarray(amplitude * fade[:, None] * np.sin(2.0 * np.pi * np.outer(t, frequency) + phase))


def _tilted(tilt: Array) -> tuple[float, float, float, float]:
    """Return the quaternion of a small rotation vector [rad]."""
    angle = float(np.linalg.norm(tilt))
    x, y, z = (tilt * (np.sinc(angle / (2.0 * np.pi)) / 2.0)).tolist()
    return float(np.cos(angle / 2.0)), x, y, z
