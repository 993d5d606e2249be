"""The lease on an arm: two services of one station never have an executor at once."""

from dataclasses import dataclass, field

import pytest

from teachpath.io.store.services import DEAD_AFTER
from teachpath.robot.arm_lease import LEASE_TIME, WATCH_INTERVAL, ArmLease
from teachpath.robot.processes import STOP_TIMEOUT


@dataclass
class Signs:
    """A service whose signs of life the database hears, or does not."""

    is_shared: bool = True
    heard_at: float = 0.0
    taken: str = ""


@dataclass
class Executor:
    """An executor that says when it was started and ended."""

    said: list[str] = field(default_factory=list)

    def start(self) -> None:
        self.said.append("start")

    def stop(self) -> None:
        self.said.append("stop")


class Bench:
    """A lease, the seconds that have passed, and what the executor was told."""

    def __init__(self) -> None:
        self.now, self.signs, self.executor, self.ends = 0.0, Signs(), Executor(), 0
        self.lease = ArmLease(self.signs, self.executor, clock=lambda: self.now)
        self.lease.when_taken(self._end)

    def _end(self) -> None:
        self.ends += 1

    def at(self, seconds: float) -> list[str]:
        self.now = seconds
        self.lease.watch()
        return self.executor.said


@pytest.fixture
def bench() -> Bench:
    return Bench()


def test_the_executor_has_ended_before_another_service_may_begin_one() -> None:
    assert LEASE_TIME + WATCH_INTERVAL + STOP_TIMEOUT < DEAD_AFTER


def test_without_a_sign_of_life_the_executor_ends_once_and_begins_again_with_the_next(bench: Bench) -> None:
    assert bench.at(0.9 * LEASE_TIME) == []
    assert bench.lease.notes() == []
    assert bench.at(LEASE_TIME) == bench.at(2 * LEASE_TIME) == ["stop"]
    assert "the database has not heard of this service" in bench.lease.notes()[0]
    bench.signs.heard_at = 1.9 * LEASE_TIME
    assert bench.at(2.1 * LEASE_TIME) == bench.at(2.2 * LEASE_TIME) == ["stop", "start"]
    assert bench.lease.notes() == []
    assert bench.ends == 0


def test_where_another_service_is_the_stations_the_executor_ends_and_the_service_is_told_to(bench: Bench) -> None:
    bench.signs.taken = "a service works as station 'cell'"
    assert bench.at(1.0) == ["stop"]
    assert bench.lease.notes() == [bench.signs.taken] == [bench.lease.taken]
    assert bench.ends == 1
    bench.signs.heard_at = 2.0  # however often it is heard of
    assert bench.at(2.0) == ["stop"]
