"""Live teleoperation on a served station: how soon a setpoint answers a hand."""

import math
import time
from typing import Any

from report import Figure, against

from teachpath.commands.rest import Api
from teachpath_client import HandReading, Link
from teachpath_proto.keys import Keys

PERIOD = 0.02  # [s] between two samples: 50 Hz
CLUTCH = 4
TRACKER = "bench-hand"


def measure(api: Api, endpoint: str, *, seconds: float) -> list[Figure]:
    """Move a hand on a circle of 10 cm, a turn in 4 s, and return the latencies that the executor measured."""
    execution = api.call("POST", "/teleoperation", {"tracker": TRACKER})
    with Link(endpoint) as link:
        _show(link, seconds)
    status: Any = api.call("GET", f"/executions/{execution['id']}")["status"]
    api.call("POST", f"/executions/{execution['id']}/stop")
    while api.call("GET", f"/executions/{execution['id']}")["status"]["state"] not in ("ended", "faulted"):
        time.sleep(0.05)
    rate = 1e6 * PERIOD
    return [
        against(f"hand to setpoint {name}", [status[field]], "us", name="period of the hand's samples", value=rate)
        for name, field in (("p50", "hand_latency_p50_us"), ("p99", "hand_latency_p99_us"))
    ] + [Figure("largest use of a limit while a hand is mirrored", (100 * status["limit_use"],), "%")]


def _show(link: Link, seconds: float) -> None:
    publisher, begin = link.publisher(Keys().samples(TRACKER)), time.monotonic()
    for number in range(1, int(seconds / PERIOD)):
        turn = 2 * math.pi * number * PERIOD / 4.0
        position = (0.1 * math.sin(turn), 0.1 * (1 - math.cos(turn)), 0.0)
        reading = HandReading(number * PERIOD, position, buttons=CLUTCH if number > 10 else 0)
        publisher.put(reading.message(number, time.time_ns()).SerializeToString())
        time.sleep(max(begin + number * PERIOD - time.monotonic(), 0.0))
