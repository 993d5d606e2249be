"""How late setpoints come to the arm while the machine is busy, `python -m tests.bench.setpoint_delay`.

Executor, session of the station and arm are three processes as in a station, on a bus of their own; both loops ask for
real-time scheduling. Beside them run loops that never wait, each in a session of its own as a browser is. Measured once
with ordinary threads of the bus in all three processes, and once as a station has them.
"""

import os
import time
from collections import deque
from multiprocessing import get_context
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess

import numpy as np

from teachpath.executor.pacing import Pacer
from teachpath.io import wire
from teachpath.io.bus import listen_on_bus, open_bus
from teachpath.io.bus_settings import BusSettings
from teachpath.realtime import EXECUTOR_PRIORITY, SIMULATOR_PRIORITY, realtime_threads, request_realtime
from teachpath.records import Setpoint
from teachpath.time_source import TimeSource
from teachpath_proto.keys import Keys
from tests.bench.report import Figure, against, machine, print_report
from tests.ports import free_endpoint

KEY = Keys("bench").setpoint("puma560")
PERIOD_NS = 4_000_000
WAY_TO_REST = np.ones((80, 3, 6))  # a long way to rest: most of what a setpoint carries
PLAYED_BEHIND = 30.0  # [ms] that an arm plays its setpoints late: a later one finds it on its way to rest
LOOK_PERIOD = 0.001  # [s] between two looks of the arm at what has come
BUSY_PROCESSES = 2 * (os.cpu_count() or 1)  # loops that never wait


def measure(*, seconds: float) -> list[Figure]:
    """Return the figures of so many seconds with ordinary threads of the bus, and of as many as in a station."""
    return [figure for realtime in (False, True) for figure in _figures(_delays(seconds, realtime), realtime)]


def _figures(delays: list[float], realtime: bool) -> list[Figure]:
    kind = "as in a station" if realtime else "ordinary"
    beside = "played behind"
    return [
        Figure(f"setpoints until the arm sees them; threads of the bus: {kind}", tuple(delays), "ms"),
        against("  99 of 100 within", [float(np.percentile(delays, 99))], "ms", name=beside, value=PLAYED_BEHIND),
        against("  the latest", [max(delays)], "ms", name=beside, value=PLAYED_BEHIND),
        Figure("  later than they are played", (float(np.sum(np.array(delays) > PLAYED_BEHIND)),), "setpoints"),
    ]


def _delays(seconds: float, realtime: bool) -> list[float]:
    """Return how long each setpoint took from the executor to the loop of the arm [ms]."""
    context, settings = get_context("spawn"), BusSettings(free_endpoint(), access_control=False)
    pipes = [context.Pipe() for _ in range(3)]
    processes: list[BaseProcess] = []
    try:
        for function, (ours, theirs) in zip((_station, _arm, _executor), pipes, strict=True):
            processes.append(context.Process(target=function, args=(settings, realtime, seconds, theirs), daemon=True))
            processes[-1].start()
            ours.recv()  # it is on the bus
        for _ in range(BUSY_PROCESSES):
            processes.append(context.Process(target=_loop, daemon=True))
            processes[-1].start()
        (_, _), (arm, _), (executor, _) = pipes
        executor.send("begin")
        executor.recv()
        arm.send("enough")
        delays: list[float] = arm.recv()
        return delays
    finally:
        for process in processes:
            process.kill()
            process.join()


def _station(settings: BusSettings, realtime: bool, _: float, parent: Connection) -> None:
    with realtime_threads(realtime):
        bus = listen_on_bus(settings)
    parent.send("ready")
    parent.poll(None)
    bus.close()


def _arm(settings: BusSettings, realtime: bool, _: float, parent: Connection) -> None:
    came: deque[bytes] = deque()
    delays: list[float] = []
    with realtime_threads(realtime):
        bus = open_bus(settings)
        bus.subscribe(KEY, lambda _, payload: came.append(payload))
    request_realtime(SIMULATOR_PRIORITY)
    parent.send("ready")
    while not parent.poll():
        while came:
            delays.append((time.time_ns() - wire.decode_setpoint(came.popleft()).sent_ns) / 1e6)
        time.sleep(LOOK_PERIOD)
    parent.send(delays)


def _executor(settings: BusSettings, realtime: bool, seconds: float, parent: Connection) -> None:
    with realtime_threads(realtime):
        bus = open_bus(settings)
    request_realtime(EXECUTOR_PRIORITY)
    parent.send("ready")
    parent.recv()
    pacer, still = Pacer(PERIOD_NS, TimeSource()), np.zeros(6)
    for cycle in range(round(seconds * 1e9 / PERIOD_NS)):
        due = pacer.wait()
        setpoint = Setpoint(cycle, due, time.time_ns(), still, still, still, False, "e1", way_to_rest=WAY_TO_REST)
        bus.publish(KEY, wire.encode_setpoint(setpoint))
    parent.send("done")
    parent.poll(None)


def _loop() -> None:
    os.setsid()
    while True:
        pass


if __name__ == "__main__":
    print(machine())
    print_report("Setpoints on a busy machine", measure(seconds=15.0))
