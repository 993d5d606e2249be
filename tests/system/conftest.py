from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.ports import free_ports
from tests.system.demos import Start
from tests.system.processes import BUSY_SETTINGS, Command, Service


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """One running service for the tests of a module; each uses tasks and trackers of its own."""
    with Service(tmp_path_factory.mktemp("station") / "data") as service:
        yield service


@pytest.fixture
def start(tmp_path: Path) -> Iterator[Start]:
    started: list[Command] = []

    def demo(*arguments: str, port: int | None = None) -> Command:
        web, bus = free_ports(2)
        environment = {**BUSY_SETTINGS, "TEACHPATH_BUS__ENDPOINT": f"tcp/127.0.0.1:{bus}"}
        words = ("demo", "--port", str(port or web), *arguments)
        started.append(Command(*words, folder=tmp_path, environment=environment))
        return started[-1]

    yield demo
    for command in started:
        command.clean_up()
