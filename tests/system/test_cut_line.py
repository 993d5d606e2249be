"""A process whose line to the bus is cut, or silent for a while: what it knows of others, and they of it."""

import time
from contextlib import suppress

import pytest
import zenoh

from teachpath.executor.joint_state_monitor import JointStateMonitor
from teachpath.io.bus import BusSettings, listen_on_bus, open_bus
from teachpath_proto.keys import Keys
from teachpath_proto.sessions import joining, open_session
from tests.ports import free_port
from tests.system.proxy import Proxy
from tests.waiting import wait_until

pytestmark = pytest.mark.system

KEYS = Keys("cut")
SHORT_LEASE = 500  # [ms]


def test_a_cut_line_is_not_the_end_of_the_driver() -> None:
    port = free_port()
    monitors = [JointStateMonitor("puma560", 6, 0.2, time.monotonic_ns) for _ in range(2)]
    service = listen_on_bus(BusSettings(endpoint=f"tcp/127.0.0.1:{port}"))
    driver = open_bus(BusSettings(endpoint=f"tcp/127.0.0.1:{port}"))
    with Proxy(port) as proxy:
        cut, whole = (open_bus(BusSettings(endpoint=f"tcp/127.0.0.1:{p}")) for p in (proxy.port, port))
        buses = dict(zip(monitors, (cut, whole), strict=True))
        known = {monitor: list[bool]() for monitor in monitors}

        def watch(monitor: JointStateMonitor) -> None:
            def changed(key: str, alive: bool) -> None:
                monitor.on_liveliness(key, alive)
                known[monitor].append(alive)

            buses[monitor].watch(KEYS.alive("robot", "puma560"), changed)

        def reason(monitor: JointStateMonitor) -> str:
            monitor.look(time.monotonic_ns())
            absence = monitor.absence(time.monotonic_ns(), 1e9, buses[monitor].is_joined)
            return absence.reason if absence.is_final else ""

        token = driver.announce(KEYS.alive("robot", "puma560"))
        for monitor in monitors:
            watch(monitor)
        wait_until(lambda: all(known.values()), "both know the driver")
        proxy.drop(cut=True)
        wait_until(lambda: monitors[0].has_lost_driver and not cut.is_joined(), "the cut is noticed")
        said = wait_until(lambda: reason(monitors[0]), "the executor knows why")
        assert said.startswith("the executor's own line to the bus is cut")
        assert known[monitors[1]] == [True]
        proxy.go_on()
        wait_until(lambda: cut.is_joined() and known[monitors[0]][-1], "it has joined again")
        token.close()
        said = wait_until(lambda: reason(monitors[1]), "the driver's end is noticed")
        assert said == "the driver of puma560 has ended:"
        assert cut.is_joined()
        for bus in (cut, whole, driver, service):
            bus.close()


def test_a_process_that_gets_no_turn_for_long_keeps_its_session() -> None:
    port, there = free_port(), dict[str, bool]()
    service = listen_on_bus(BusSettings(endpoint=f"tcp/127.0.0.1:{port}"))
    service.watch("cut/alive/*", lambda key, alive: there.__setitem__(key.rpartition("/")[2], alive))
    heard: list[bytes] = []
    service.subscribe("cut/said", lambda _, payload: heard.append(payload))
    with Proxy(port) as proxy:
        values = joining(f"tcp/127.0.0.1:{proxy.port}", None, timeout=10.0)
        sessions = [open_session({**values, **lease}) for lease in ({}, {"transport/link/tx/lease": SHORT_LEASE})]
        names = zip(("ours", "short"), sessions, strict=True)
        tokens = [session.liveliness().declare_token(f"cut/alive/{name}") for name, session in names]
        wait_until(lambda: "ours" in there and "short" in there, "both are known")
        wait_until(lambda: sessions[0].put("cut/said", b"before") or heard, "it is heard")
        proxy.stall()  # as for a process that is stopped: nothing comes, and nothing is closed
        wait_until(lambda: not there["short"], "a session with a short lease is given up")
        assert there["ours"]
        sessions[0].put("cut/said", b"meanwhile")
        proxy.go_on()
        wait_until(lambda: b"meanwhile" in heard, "what it said meanwhile is heard")
        assert there["ours"]
        del tokens
        for session in sessions:
            with suppress(zenoh.ZError):
                session.close()  # type: ignore[no-untyped-call]
    service.close()
