"""Executor, simulated arm or service die while the arm moves: what was under way ends, and the next start works."""

import os
import signal
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from shutil import copytree

import pytest

from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.robot.processes import MAX_DEATHS
from teachpath_client.errors import Refused
from teachpath_client.models import Execution
from tests.contract.rows import a_job, learned
from tests.system.processes import Command, Service, stop_arm
from tests.unit.motion.ways import MIDDLE, way
from tests.waiting import HANG, wait_until

pytestmark = pytest.mark.system

TASK = "t"


@pytest.fixture(scope="module")
def template(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A data folder with one learned path, of which every station gets a copy."""
    folder = tmp_path_factory.mktemp("template") / "data"
    store = Store(StoreSettings(data_dir=str(folder)))
    store.ensure_task(TASK, scene="empty", calibration="identity")
    store.add_job(a_job("learn-1", kind="learn"))
    found = learned()
    store.finish_learning("learn-1", replace(found, clusters=found.clusters[:1], paths=(way(MIDDLE),)))
    store.close()
    return folder


@pytest.fixture
def data(template: Path, tmp_path: Path) -> Path:
    """A data folder for stations of one test."""
    return copytree(template, tmp_path / "data")


@pytest.fixture(scope="module")
def service(template: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """The station of those tests that leave it as it was."""
    with Service(copytree(template, tmp_path_factory.mktemp("station") / "data")) as service:
        yield service


def planned(service: Service) -> str:
    """Plan the path at this station, for a certificate is of one station."""
    (run,) = service.station.runs(TASK)
    plan = service.station.plan(run.paths[0])
    service.station.wait_for_arm(timeout=HANG)
    return plan.id


def begin(service: Service, *, override: float = 1.0) -> Execution:
    return service.station.begin_execution(planned(service), override=override)


def begin_when_arm_speaks(service: Service) -> Execution:
    """Start the path as soon as another simulated arm publishes its joint state."""
    plan = planned(service)

    def begun() -> Execution | None:
        try:
            return service.station.begin_execution(plan)
        except Refused:  # it is silent until then
            return None

    found = wait_until(begun, "the arm speaks again")
    assert found is not None
    return found


def wait_state(service: Service, execution: Execution, *states: str) -> Execution:
    def present() -> Execution | None:
        found = service.station.get_execution(execution.id)
        return found if found.status.state in states else None

    found = wait_until(present, f"the execution is {' or '.join(states)}")
    assert found is not None
    return found


def follow(service: Service) -> Execution:
    """Start an execution, and let it creep once it follows the path: its end is far, however late the test looks.

    Where this test got no turn before that end, another one is started.
    """

    def creeping() -> Execution | None:
        execution = wait_state(service, begin(service, override=0.5), "following", "ended")
        with suppress(Refused):  # it has ended meanwhile
            service.station.override(execution.id, 0.02)
        now = service.station.get_execution(execution.id)
        return now if now.status.state == "following" else None

    found = wait_until(creeping, "an execution creeps")
    assert found is not None
    return found


def kill(service: Service, part: str) -> int:
    (pid,) = service.find(f"[{part}]")
    os.kill(pid, signal.SIGKILL)
    return pid


def wait_note(service: Service, *words: str) -> str:
    def note() -> str:
        return next((n for n in service.station.health().notes if all(word in n for word in words)), "")

    return wait_until(note, f"a note says {words}")


def test_the_death_of_the_executor_ends_its_execution_and_another_executor_takes_its_place(service: Service) -> None:
    execution = follow(service)
    kill(service, "executor")
    status = wait_state(service, execution, "faulted").status
    assert status.reason.startswith("the executor died (killed by signal 9"), status.reason
    wait_note(service, "the executor died (killed by signal 9", "look where the arm stands, then start again")
    assert stop_arm(service.station, execution.id).status.state == "faulted"
    again = service.station.finish(begin(service))
    assert (again.status.state, again.status.progress) == ("ended", pytest.approx(1.0))
    assert service.station.get_execution(execution.id).status == status


def test_the_death_of_the_simulated_arm_ends_its_execution_and_another_one_takes_its_place(service: Service) -> None:
    execution = follow(service)
    kill(service, "simulator")
    status = wait_state(service, execution, "faulted").status
    assert status.reason == "the driver of puma560 has ended: look where the arm stands, then start again"
    wait_note(service, "the simulator died (killed by signal 9", "its execution ended as faulted", "start again")
    wait_until(lambda: service.station.health().processes["simulator"] == "running", "another arm is there")
    again = service.station.finish(begin_when_arm_speaks(service))
    assert (again.status.state, again.status.progress) == ("ended", pytest.approx(1.0))


def test_an_executor_that_dies_again_and_again_is_given_up(data: Path) -> None:
    killed: set[int] = set()
    with Service(data) as service:
        for _ in range(MAX_DEATHS):
            wait_until(lambda: set(service.find("[executor]")) - killed, "another executor is there")
            killed.add(kill(service, "executor"))
        note = wait_note(service, "the executor died", "is not started again", "then restart the service")
        assert f"{MAX_DEATHS} times" in note
        assert service.station.health().processes == {"executor": "ended", "simulator": "running"}
        assert service.find("[executor]") == []


def test_nothing_is_under_way_after_the_service_was_killed(data: Path) -> None:
    with Service(data) as killed:
        execution = follow(killed)
        killed.kill()
        killed.wait_gone()
    with Service(data) as next_one:
        status = next_one.station.get_execution(execution.id).status
        assert (status.state, status.execution) == ("faulted", execution.id)
        assert status.reason.startswith("the service ended before the execution did")
        assert all(one.status.state in ("ended", "faulted") for one in next_one.station.executions())


def test_what_is_under_way_when_the_service_is_stopped_has_ended(data: Path) -> None:
    with Service(data) as stopped:
        execution = follow(stopped)
    with Service(data) as next_one:
        status = next_one.station.get_execution(execution.id).status
        assert (status.state, status.reason) == ("ended", "the executor was told to stop")


def test_an_execution_that_has_ended_leaves_an_arm_that_may_start_at_once(service: Service) -> None:
    execution = follow(service)
    assert execution.plan is not None
    for _ in range(10):
        stop_arm(service.station, execution.id)
        wait_state(service, execution, "ended")
        execution = service.station.begin_execution(execution.plan)  # without another try
        wait_state(service, execution, "approaching", "following", "ended")
    stop_arm(service.station, execution.id)
    wait_state(service, execution, "ended")


@pytest.fixture
def command(service: Service, tmp_path: Path) -> Iterator[Command]:
    """A `teachpath run` that moves the arm slowly."""
    words = ("run", planned(service), "--override", "0.1", "--url", service.url)
    command = Command(*words, folder=tmp_path)
    yield command
    command.clean_up()


def moved_by(command: Command, service: Service) -> Execution:
    """Return the execution of a running command as soon as the arm follows the path."""

    def begun() -> Execution | None:
        assert command.process.poll() is None, command.err
        newest = next(iter(service.station.executions()), None)
        return newest if newest and newest.status.state == "following" else None

    found = wait_until(begun, "the arm follows the path")
    assert found is not None
    return found


def test_the_arm_holds_when_the_command_that_moves_it_is_killed(service: Service, command: Command) -> None:
    execution = moved_by(command, service)
    assert service.station.get_lease().holder == "teachpath run"
    with pytest.raises(Refused, match="teachpath run is in control"):
        service.station.override(execution.id, 1.0)
    command.process.kill()
    held = wait_state(service, execution, "held").status
    assert held.reason.startswith("nothing was heard of teachpath run, who was in control; resume"), held.reason
    service.station.steer(execution.id, "resume")
    wait_state(service, execution, "following")
    stop_arm(service.station, execution.id)
    wait_state(service, execution, "ended")


def test_ctrl_c_stops_the_arm_and_gives_control_back(service: Service, command: Command) -> None:
    execution = moved_by(command, service)
    command.interrupt()
    assert command.wait() == 0
    assert f"{execution.id} ended" in command.out
    assert service.station.get_execution(execution.id).status.reason == "stopped by teachpath run"
    assert service.station.get_lease().holder == ""
