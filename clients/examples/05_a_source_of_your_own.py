"""Make a device of your own a source, so that `teachpath-client tracker --source NAME` publishes from it.

A source is a context manager that yields `HandReading`s. Here a made-up device carries the object of the scene
`paper` to the other side. In a package of yours, name the function `arc` in pyproject.toml, and the client finds it:

    [project.entry-points."teachpath.sources"]
    arc = "mypackage.mymodule:arc"

    python 05_a_source_of_your_own.py [--endpoint tcp/127.0.0.1:7447]
"""

import argparse
import math
from collections.abc import Iterator
from typing import Self

from teachpath_client import HandReading, Link, Tracker
from teachpath_client.devices import Capabilities
from teachpath_client.live import record_live

RATE, GRASP = 50.0, 1  # [Hz]; the button that is held while the object is carried


class Arc:
    """Readings along an arc, `height` [m] high; a driver would open its port when it is entered."""

    capabilities = Capabilities(rate=RATE, sensors=0, orientation=False, live=False)

    def __init__(self, height: str = "0.1") -> None:
        self._height, self._ended = float(height), False

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End the iteration soon."""
        self._ended = True

    def __iter__(self) -> Iterator[HandReading]:
        for i in range(200):
            u = min(max((i - 25) / 149, 0.0), 1.0)
            place = (0.58 + 0.2 * math.sin(math.pi * u), -0.28 + 0.56 * u, 0.52 + self._height * math.sin(math.pi * u))
            if not self._ended:
                yield HandReading(i / RATE, place, buttons=GRASP if 25 <= i < 175 else 0)


def arc(**options: str) -> Arc:
    """An arc to the other side of the table; height=METRES."""
    return Arc(**options)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Publish one demonstration from a source.")
    parser.add_argument("--endpoint", default="tcp/127.0.0.1:7447")
    with arc(height="0.12") as source, Link(parser.parse_args().endpoint) as link:
        report = record_live(Tracker(link, "arc-source"), source, "arc", scene="paper", speed=4.0)
    print(f"{len(report.demonstrations)} demonstrations of {report.received} samples, {report.lost} lost")
