"""Live teleoperation: how soon a setpoint of a served station answers a hand, and what planning takes of a period.

The second alone, on a hand that wanders at random: `python -m tests.bench.teleoperation`.
"""

import gc
import math
import time

import numpy as np

from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.builtin_scenes import paper_scene
from teachpath.motion.collision.collision_model import CollisionModel
from teachpath.motion.execution.teleop_follower import TeleopFollower
from teachpath.motion.settings import MotionSettings
from teachpath_client import HandReading, Link, Station
from teachpath_proto.keys import Keys
from tests.bench.report import Figure, against, machine, print_report

PERIOD = 0.02  # [s] between two samples: 50 Hz
CONTROL_PERIOD = 0.004  # [s]
CLUTCH = 4
TRACKER = "bench-hand"
STEP, TURN_AFTER, REACH = 0.02, 10, 0.1  # [m] of the wandering hand a sample, samples in one direction, and [m] around


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


def planning_slices(*, samples: int) -> list[Figure]:
    """Return what a slice of planning takes of the processor while a hand wanders for so many samples."""
    rng, hand, taken = np.random.default_rng(0), np.zeros(3), []
    follower = TeleopFollower(
        CollisionModel(paper_scene(), Arm.of_variant()), np.array(MotionSettings().home), MotionSettings()
    )
    follower.engage(hand)
    gc.disable()  # as in the executor
    for number in range(samples):
        if number % TURN_AFTER == 0:
            way = rng.normal(0.0, STEP, 3)
        hand = np.clip(hand + way, -REACH, REACH)
        follower.set_hand(hand, number + 1)
        for _ in range(round(PERIOD / CONTROL_PERIOD)):
            follower.step()
            began = time.thread_time()
            follower.advance_planning()
            taken.append(1e3 * (time.thread_time() - began))
    gc.enable()
    period = 1e3 * CONTROL_PERIOD
    return [
        against(f"slice of planning {name}", [value], "ms", name="control period", value=period)
        for name, value in (
            ("p50", float(np.median(taken))),
            ("p99", float(np.percentile(taken, 99))),
            ("at most", max(taken)),
        )
    ]


if __name__ == "__main__":
    print(machine())
    print_report("The live hand", planning_slices(samples=500))
