"""Live teleoperation on a served station: how soon a setpoint answers a hand."""

import math
import time

from teachpath_client import HandReading, Link, Station
from teachpath_proto.keys import Keys
from tests.bench.report import Figure, against

PERIOD = 0.02  # [s] between two samples: 50 Hz
CLUTCH = 4
TRACKER = "bench-hand"


def measure(station: Station, endpoint: str, *, seconds: float) -> list[Figure]:
    """Move a hand on a circle of 10 cm, a turn in 4 s, and return the latencies that the executor measured."""
    execution = station.begin_teleoperation(TRACKER)
    with Link(endpoint) as link:
        _show(link, seconds)
    status = station.get_execution(execution.id).status
    station.wait(station.stop(execution.id))
    rate = 1e6 * PERIOD
    return [
        against(
            f"hand to setpoint {name}", [getattr(status, field)], "us", name="period of the hand's samples", value=rate
        )
        for name, field in (("p50", "hand_latency_p50_us"), ("p99", "hand_latency_p99_us"))
    ] + [Figure("largest use of a limit while a hand is mirrored", (100 * status.limit_use,), "%")]


def _show(link: Link, seconds: float) -> None:
    publisher, begin = link.publisher(Keys().samples(TRACKER)), time.monotonic()
    for number in range(1, int(seconds / PERIOD)):
        turn = 2 * math.pi * number * PERIOD / 4.0
        position = (0.1 * math.sin(turn), 0.1 * (1 - math.cos(turn)), 0.0)
        reading = HandReading(number * PERIOD, position, buttons=CLUTCH if number > 10 else 0)
        publisher.put(reading.message(number, time.time_ns()).SerializeToString())
        time.sleep(max(begin + number * PERIOD - time.monotonic(), 0.0))
