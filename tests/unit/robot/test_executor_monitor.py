"""What the service keeps of the executor: no execution stays under way when its executor is gone."""

from collections.abc import Iterator
from dataclasses import replace

import pytest

from teachpath.io import wire
from teachpath.io.memory_bus import MemoryBus
from teachpath.io.store.store import Store
from teachpath.records import ExecutorStatus
from teachpath.robot.executor_monitor import ExecutorMonitor
from teachpath_proto.control import ExecutorState
from teachpath_proto.keys import Keys
from tests.waiting import wait_until

KEYS = Keys()
FOLLOWING_STATUS = ExecutorStatus("e1", ExecutorState.FOLLOWING, progress=0.5)


@pytest.fixture
def bus() -> MemoryBus:
    return MemoryBus()


@pytest.fixture
def monitor(bus: MemoryBus, store: Store) -> Iterator[ExecutorMonitor]:
    monitor = ExecutorMonitor(bus, KEYS, store)
    monitor.start()
    yield monitor
    monitor.stop()


def publish(bus: MemoryBus, status: ExecutorStatus) -> None:
    bus.publish(KEYS.executor_status, wire.encode_status(status))


def begin(monitor: ExecutorMonitor) -> None:
    monitor.track("e1", None, ExecutorStatus("e1", ExecutorState.STARTING))


def test_the_newest_status_is_kept_and_the_end_stored(bus: MemoryBus, monitor: ExecutorMonitor, store: Store) -> None:
    begin(monitor)
    publish(bus, FOLLOWING_STATUS)
    assert monitor.get("e1").status == FOLLOWING_STATUS
    ended = replace(FOLLOWING_STATUS, state=ExecutorState.ENDED, progress=1.0)
    publish(bus, ended)
    assert monitor.get("e1").status == ended
    wait_until(lambda: store.execution("e1").status == ended, "the end is stored")


@pytest.mark.parametrize("heard", [True, False])
def test_the_death_of_the_executor_ends_what_was_under_way(
    bus: MemoryBus, monitor: ExecutorMonitor, store: Store, heard: bool
) -> None:
    begin(monitor)
    if heard:
        publish(bus, FOLLOWING_STATUS)
    monitor.end_lost("killed by signal 9, Killed")
    wait_until(lambda: store.execution("e1").status.state is ExecutorState.FAULTED, "the end is stored")
    publish(bus, FOLLOWING_STATUS)  # it was on its way when the executor died
    assert monitor.get("e1").status.state is ExecutorState.FAULTED
    assert monitor.get("e1").status.reason.startswith("the executor died (killed by signal 9, Killed); look where")
    assert monitor.get("e1").status.progress == (0.5 if heard else 0.0)
    assert monitor.status is None
    publish(bus, ExecutorStatus())  # of the executor that was started in its place
    assert monitor.status == ExecutorStatus()


def test_motion_nobody_asked_for_stays_unacknowledged_when_the_executor_dies(
    bus: MemoryBus, monitor: ExecutorMonitor
) -> None:
    publish(bus, ExecutorStatus(unasked_motion="the arm moved"))
    monitor.end_lost("killed by signal 9, Killed")
    publish(bus, ExecutorStatus())  # of the executor that was started in its place
    assert monitor.status == ExecutorStatus(unasked_motion="the arm moved")
    monitor.end_lost("killed by signal 9, Killed")  # that one, too
    assert monitor.unacknowledged == "the arm moved"
    monitor.unacknowledged = ""  # somebody acknowledges it
    publish(bus, ExecutorStatus())
    assert monitor.status == ExecutorStatus()


def test_an_execution_that_has_ended_keeps_its_end(bus: MemoryBus, monitor: ExecutorMonitor, store: Store) -> None:
    begin(monitor)
    ended = ExecutorStatus("e1", ExecutorState.ENDED, "stopped by Ada")
    publish(bus, ended)
    monitor.end_lost("it ended by itself")
    wait_until(lambda: store.execution("e1").status.state is not ExecutorState.STARTING, "the end is stored")
    assert monitor.get("e1").status == store.execution("e1").status == ended


def test_what_an_earlier_service_left_under_way_ends_with_the_next_one(bus: MemoryBus, store: Store) -> None:
    for state in ExecutorState:
        store.put_execution(state.value, None, ExecutorStatus(state.value, state, "as it was"))
    monitor = ExecutorMonitor(bus, KEYS, store)
    monitor.start()
    monitor.stop()
    for state in ExecutorState:
        kept = store.execution(state.value).status
        if state.is_resting:
            assert (kept.state, kept.reason) == (state, "as it was")
        else:
            assert kept.state is ExecutorState.FAULTED
            assert kept.reason.startswith("the service ended before the execution did")
    assert store.unfinished_executions() == []


def test_what_is_under_way_when_the_service_ends_is_stored_as_faulted(bus: MemoryBus, store: Store) -> None:
    monitor = ExecutorMonitor(bus, KEYS, store)
    monitor.start()
    begin(monitor)
    publish(bus, FOLLOWING_STATUS)
    monitor.stop()
    kept = store.execution("e1").status
    assert (kept.state, kept.progress) == (ExecutorState.FAULTED, FOLLOWING_STATUS.progress)


def test_an_execution_that_was_refused_is_not_lost_as_well(
    bus: MemoryBus, monitor: ExecutorMonitor, store: Store
) -> None:
    begin(monitor)
    monitor.refuse("e1", "the arm still moves")
    monitor.end_lost("it ended by itself")
    assert monitor.get("e1").status.reason == "the arm still moves"
