"""Stop on the page and on real processes: NOT STOPPED until the executor's own status shows it, whoever answers."""

import os
import signal
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import zenoh
from fastapi import FastAPI

from teachpath.api.faults import answer_errors
from teachpath.executor.loop import Executor
from teachpath.executor.settings import ExecutorSettings
from teachpath.io import wire
from teachpath.io.bus import BusSettings, open_bus
from teachpath.motion.planning.signature import SigningKey
from teachpath.records import Command, ExecutorStatus
from teachpath.robot.stopper import Stopper
from teachpath_client.__main__ import main
from teachpath_client.bus_stop import stop_over_bus
from teachpath_client.errors import NotStopped
from teachpath_client.link import Link
from teachpath_client.models import Plan
from teachpath_proto.control import CommandVerb, ExecutorState
from teachpath_proto.logins import Login, Role, find_login
from tests.system.access import barriers
from tests.system.processes import Command as Process
from tests.system.processes import Service, confirmed, run, stop_arm
from tests.system.stop_places import stop_faults
from tests.system.test_lateness import executor, ready_plan
from tests.system.visits import KEYS, Server, Visit
from tests.waiting import HANG, wait_until

pytestmark = pytest.mark.system

STOP = KEYS.executor_stop
CREEP = 0.02  # share of the speed at which the end of the path is far, however late the next order comes
SLOW_OVERRIDE = 0.05  # share of the speed at which the arm is on its way for longer than a lease lasts
WARNING = "Press the emergency stop of the arm"


def pressed(visit: Visit) -> str:
    """What the button says."""
    return str(visit.page.locator("#stop").inner_text())


def wait_not_stopped(visit: Visit) -> None:
    visit.wait(lambda: pressed(visit) == "NOT STOPPED")
    warning = visit.page.locator("#not-stopped")
    assert warning.is_visible()
    assert WARNING in warning.inner_text()


def wait_confirmed(visit: Visit) -> None:
    visit.wait(lambda: pressed(visit) == "Stop the arm")
    assert not visit.page.locator("#not-stopped").is_visible()
    assert "has confirmed the stop" in visit.page.locator("#message").inner_text()


class StopServer(Server):
    """The page's server with the real stop and the real executor, on the bus within this process."""

    def __init__(self) -> None:
        super().__init__()
        self.stopper = Stopper(self.bus, KEYS)
        self.bus.subscribe(KEYS.executor_status, lambda _, p: self.stopper.on_status(wire.decode_status(p)))
        self._over = threading.Event()
        settings, key = ExecutorSettings(realtime=False), SigningKey(bytes(32))
        self._executor = threading.Thread(
            target=lambda: Executor(self.bus, KEYS, settings, signing_key=key).run(self._over)
        )

    def web_app(self, demonstrations: int) -> FastAPI:
        app = super().web_app(demonstrations)
        app.add_api_route("/api/v1/stop", self.stop_arm, methods=["POST"])
        answer_errors(app)
        return app

    def stop_arm(self) -> dict[str, Any]:
        status = self.stopper.stop(Command(CommandVerb.STOP), lambda: False)
        return {"state": status.state}

    def start_executor(self) -> None:
        self._executor.start()

    def stop(self) -> None:
        self._over.set()
        self._executor.join()
        self.stopper.close()
        super().stop()


@pytest.fixture
def server() -> Iterator[StopServer]:
    server = StopServer()
    server.start(demonstrations=3)
    yield server
    server.stop()


def test_the_page_says_not_stopped_until_the_executor_confirms_it(browser: Any, server: StopServer) -> None:
    visit = Visit(browser, server.address)
    visit.page.locator("#stop").click()
    wait_not_stopped(visit)
    assert stop_faults(visit.page, "not stopped") == []
    assert barriers(visit.page, "not stopped") == []
    server.start_executor()
    wait_confirmed(visit)
    visit.page.close()


def test_stop_is_in_reach_while_the_page_connects(browser: Any, server: StopServer) -> None:
    page = browser.new_page()
    page.set_default_timeout(1000 * HANG)
    page.route_web_socket("**/api/v1/*", lambda socket: None)  # open, and nobody says anything
    page.goto(server.address)
    page.wait_for_selector("html[data-connection=connecting][data-events=connecting]", state="attached")
    assert stop_faults(page, "connecting") == []
    page.locator("#stop").click()
    page.wait_for_selector("#not-stopped:not([hidden])")
    server.start_executor()
    page.wait_for_selector("#not-stopped", state="hidden")
    page.close()


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    with Service(tmp_path_factory.mktemp("station") / "data") as service:
        yield service


@pytest.fixture(scope="module")
def plan(service: Service) -> Plan:
    return ready_plan(service, "stopped")


def begin(service: Service, plan: Plan) -> str:
    """Move the arm along a plan; return the execution once it creeps on, clear of where the object lay."""
    station = service.station
    station.wait_for_arm(timeout=HANG)
    execution = station.begin_execution(plan.id, override=0.2).id
    wait_until(lambda: station.get_execution(execution).status.progress > 0.2, "it is on its way")
    station.override(execution, CREEP)
    return execution


def wait_ended(service: Service, execution: str) -> None:
    wait_until(lambda: service.station.get_execution(execution).status.state == "ended", "the arm rests")


def test_an_executor_that_does_not_answer_is_said_to_be_not_stopped(
    browser: Any, service: Service, plan: Plan, tmp_path: Path
) -> None:
    visit = Visit(browser, service.url)
    execution = begin(service, plan)
    visit.wait(lambda: visit.page.evaluate("teachpath.state().executor?.state") == "following")
    assert stop_faults(visit.page, "executing") == []
    pid = executor(service)
    os.kill(pid, signal.SIGSTOP)
    try:
        visit.page.keyboard.press("Space")
        wait_not_stopped(visit)
        with pytest.raises(NotStopped, match=WARNING.lower()):
            service.station.stop(execution)
        said = run("stop", "--url", service.url, folder=tmp_path)
        assert said.process.returncode == 1
        assert "NOT STOPPED" in said.err
        assert "stopped:" not in said.out
        with Link(service.endpoint, role=Role.OPERATOR) as link, pytest.raises(NotStopped, match=WARNING.lower()):
            stop_over_bus(link, execution, timeout=0.2)
        visit.wait(lambda: visit.page.evaluate("teachpath.state().executor === null"))
        assert pressed(visit) == "NOT STOPPED"
    finally:
        os.kill(pid, signal.SIGCONT)
    wait_confirmed(visit)
    wait_ended(service, execution)
    visit.page.close()
    said_stopped = lambda: run("stop", "--url", service.url, folder=tmp_path).out.startswith("stopped: ")  # noqa: E731
    wait_until(said_stopped, "the command says that it is stopped")


def test_the_arm_stops_over_the_bus_alone(service: Service, plan: Plan, capsys: pytest.CaptureFixture[str]) -> None:
    execution = begin(service, plan)
    confirmed(lambda: stop_by_client(service))
    assert capsys.readouterr().out.startswith(f"stopped: {execution} ")
    wait_ended(service, execution)
    assert service.station.get_execution(execution).status.reason == "stopped by teachpath-client stop"


def stop_by_client(service: Service) -> bool:
    try:
        main(["stop", "--endpoint", service.endpoint])
    except SystemExit as ended:
        raise NotStopped(str(ended)) from None
    return True


def test_the_arm_is_held_when_the_program_in_control_is_killed(service: Service, plan: Plan, tmp_path: Path) -> None:
    station = service.station
    station.wait_for_arm(timeout=HANG)
    before = {each.id for each in station.executions()}
    moving = lambda: [e for e in station.executions() if e.id not in before and e.status.cycles > 0]  # noqa: E731
    killed = Process("run", plan.id, "--url", service.url, "--override", str(SLOW_OVERRIDE), folder=tmp_path)
    try:
        (execution,) = wait_until(moving, "the arm moves")
    finally:
        killed.clean_up()  # as kill -9
    wait_until(lambda: station.get_execution(execution.id).status.state == "held", "the arm is held")
    wait_until(lambda: station.get_lease().holder == "", "nobody is in control")
    stop_arm(station, execution.id)
    wait_ended(service, execution.id)


# the attack


def impostor(endpoint: str, login: Login | None) -> tuple[Any, list[bytes]]:
    """A client that answers every stop in the executor's place, and all that it was asked."""
    config = zenoh.Config()
    config.insert_json5("mode", '"client"')
    config.insert_json5("connect/endpoints", f'["{endpoint}"]')
    config.insert_json5("scouting/multicast/enabled", "false")
    if login is not None:
        config.insert_json5("transport/auth/usrpwd", f'{{"user": "{login.user}", "password": "{login.password}"}}')
    swallowed: list[bytes] = []

    def answer(query: Any) -> None:
        with query:
            swallowed.append(query.payload.to_bytes() if query.payload else b"")
            query.reply(STOP, wire.encode_status(ExecutorStatus(state=ExecutorState.ENDED)))

    session = zenoh.open(config)
    session.declare_queryable(STOP, answer, complete=True)
    return session, swallowed


def test_a_client_of_the_bus_cannot_swallow_a_stop(service: Service, plan: Plan) -> None:
    session, swallowed = impostor(service.endpoint, find_login(service.endpoint, Role.TRACKER))
    try:
        execution = begin(service, plan)
        assert stop_arm(service.station, execution).status.ending
        wait_ended(service, execution)
        assert not swallowed
    finally:
        session.close()


def test_whoever_answers_a_stop_on_an_open_bus_the_arm_stops(tmp_path: Path) -> None:
    with Service(tmp_path / "data", TEACHPATH_BUS__ACCESS_CONTROL="false") as service:
        plan = ready_plan(service, "open")
        session, swallowed = impostor(service.endpoint, None)
        bus = open_bus(BusSettings(endpoint=service.endpoint))

        def is_asked() -> bool:
            bus.ask(STOP, wire.encode_command(Command(CommandVerb.STOP, "nothing")))
            return bool(swallowed)

        wait_until(is_asked, "stops that are asked for come to the impostor")
        try:
            execution = begin(service, plan)
            before = len(swallowed)
            assert stop_arm(service.station, execution).status.ending
            wait_until(lambda: len(swallowed) > before, "the question was swallowed")
            wait_ended(service, execution)
        finally:
            bus.close()
            session.close()
