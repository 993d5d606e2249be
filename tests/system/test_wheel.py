"""The wheel in clean environments: the client alone, the service, and each extra, with nothing but what it asks for."""

import subprocess
import sys
import venv
import zipfile
from collections.abc import Iterator
from contextlib import suppress
from importlib.metadata import distribution
from pathlib import Path

import httpx
import pytest

import teachpath
from tests.distributions import required
from tests.ports import free_ports
from tests.waiting import HANG, wait_until

pytestmark = pytest.mark.system

ROOT = Path(__file__).parents[2]
EXTRAS = {
    "dask": "distributed",
    "lerobot": "pyarrow.parquet",
    "postgres": "psycopg",
    "ros": "rosbags.highlevel",
    "s3": "obstore.store",
}
CLIENT = "import teachpath_client, sys; print(teachpath_client.__version__)"
LEARN_PROGRAM = """
import numpy as np, teachpath
from importlib.metadata import entry_points
[reader.load() for reader in entry_points(group="teachpath.readers")]
t = np.linspace(0, 1, 60)
shown = [np.column_stack([0.5 * np.cos(t + s), 0.5 * np.sin(t + s), 0.5 + 0.1 * t]) for s in (0, 0.001, 0.003)]
print(len(teachpath.learn(shown).paths))
"""


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)]
    subprocess.run(command, cwd=ROOT, check=True, capture_output=True, timeout=HANG)
    (built,) = folder.iterdir()
    return built


class Environment:
    """A Python environment with the wheel and what it needs with these extras, linked from the one of the tests."""

    def __init__(self, folder: Path, wheel: Path, *extras: str) -> None:
        venv.create(folder, with_pip=False)
        (site,) = folder.glob("lib/python*/site-packages")
        with zipfile.ZipFile(wheel) as content:
            content.extractall(site)
        for name in required(*extras):
            brought = distribution(name)
            for top in {file.parts[0] for file in brought.files or [] if file.parts[0] != ".."}:
                with suppress(FileExistsError):  # a folder that several distributions share
                    (site / top).symlink_to(str(brought.locate_file(top)))
        self.folder, self.python = folder, folder / "bin" / "python"

    def run(self, *words: str) -> str:
        """Run Python as nobody but a user does: elsewhere, and without the settings of the tests."""
        ended = subprocess.run(
            [self.python, *words], cwd=self.folder, env=self.variables, capture_output=True, text=True, timeout=HANG
        )
        assert (ended.returncode, ended.stderr) == (0, "")
        return ended.stdout

    @property
    def variables(self) -> dict[str, str]:
        return {"HOME": str(self.folder), "PATH": "/usr/bin:/bin"}


@pytest.fixture(scope="module")
def service(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Environment:
    return Environment(tmp_path_factory.mktemp("environment") / "service", wheel, "service")


@pytest.fixture
def served(service: Environment) -> Iterator[str]:
    """The address of a station that the environment's own service serves."""
    web, bus = free_ports(2)
    words = ["-m", "teachpath", "serve", "--port", str(web), "--data", str(service.folder / "data")]
    variables = {**service.variables, "TEACHPATH_BUS__ENDPOINT": f"tcp/127.0.0.1:{bus}"}
    with (service.folder / "said").open("wb") as said:
        process = subprocess.Popen(
            [service.python, *words], cwd=service.folder, env=variables, stdout=said, stderr=said
        )
    try:
        address = f"http://127.0.0.1:{web}"

        def answers() -> bool:
            assert process.poll() is None, (service.folder / "said").read_text()
            with suppress(httpx.TransportError):
                return httpx.get(f"{address}/api/v1/health/live", timeout=HANG).is_success
            return False

        wait_until(answers, "the service answers")
        yield address
    finally:
        process.terminate()
        process.wait(HANG)


def test_the_client_alone_has_its_command_and_nothing_of_the_service(wheel: Path, tmp_path: Path) -> None:
    client = Environment(tmp_path / "client", wheel)
    assert client.run("-c", CLIENT) == f"{teachpath.__version__}\n"
    assert "synthetic" in client.run("-m", "teachpath_client", "--help")


def test_the_service_learns_and_serves_its_page(service: Environment, served: str) -> None:
    assert service.run("-m", "teachpath", "--version") == f"teachpath {teachpath.__version__}\n"
    assert int(service.run("-c", LEARN_PROGRAM)) == 1
    page = httpx.get(served, timeout=HANG)
    assert page.is_success
    assert "<title>" in page.text
    assert httpx.get(f"{served}/openapi.json", timeout=HANG).json()["info"]["version"] == teachpath.__version__


@pytest.mark.parametrize("extra", EXTRAS)
def test_each_extra_brings_what_it_is_for(wheel: Path, tmp_path: Path, extra: str) -> None:
    Environment(tmp_path / extra, wheel, extra).run("-c", f"import {EXTRAS[extra]}")
