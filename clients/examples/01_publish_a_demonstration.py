"""Publish demonstrations of your own over Zenoh, as a tracker does.

Whatever moves can teach: give `Tracker.publish` readings with a time, a position and either glove flexions or the grasp
button. Here a function draws an arc from the object of the scene `paper` to the other side, three times; the
station cuts the stream where the hand grasps and rests. Run `teachpath serve` first, then:

    python 01_publish_a_demonstration.py [--task arc] [--endpoint tcp/127.0.0.1:7447]
"""

import argparse
import itertools
import math
from collections.abc import Iterator

from teachpath_client import HandReading, Link, Tracker

PERIOD = 0.02  # [s]: 50 readings a second
START, GOAL = (0.58, -0.28, 0.52), (0.58, 0.28, 0.52)  # of the object's centre [m]
GRASP = 1  # the button that is held while the object is carried


def arc(height: float) -> Iterator[tuple[tuple[float, float, float], int]]:
    """Yield the hand's positions and buttons: wait at the start, carry over an arc, let go, wait."""
    yield from [(START, 0)] * 25
    for i in range(150):
        u = (1 - math.cos(math.pi * i / 149)) / 2
        x, y, z = (a + u * (b - a) for a, b in zip(START, GOAL, strict=True))
        yield (x + 0.2 * math.sin(math.pi * u), y, z + height * math.sin(math.pi * u)), GRASP
    yield from [(GOAL, 0)] * 25


def readings() -> Iterator[HandReading]:
    """Yield three demonstrations, a little different from one another."""
    moves = itertools.chain.from_iterable(arc(height) for height in (0.10, 0.11, 0.12))
    for i, (position, buttons) in enumerate(moves):
        yield HandReading(i * PERIOD, position, buttons=buttons)


def main() -> None:
    """Record the demonstrations and print the station's account of every sample."""
    parser = argparse.ArgumentParser(description="Publish three demonstrations of an arc.")
    parser.add_argument("--task", default="arc")
    parser.add_argument("--endpoint", default="tcp/127.0.0.1:7447")
    parser.add_argument("--speed", type=float, default=1.0)
    options = parser.parse_args()
    with Link(options.endpoint) as link:
        tracker = Tracker(link, "arc-hand")
        tracker.start(options.task, scene="paper")
        tracker.publish(readings(), speed=options.speed)
        report = tracker.stop()
    print(f"{len(report.demonstrations)} demonstrations of {report.received} samples, {report.lost} lost")


if __name__ == "__main__":
    main()
