"""Commands of teachpath in processes of their own, and everything they start."""

import os
import signal
import subprocess
import sys
import uuid
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import TypeVar

import httpx

from teachpath_client.errors import NotStopped
from teachpath_client.models import Execution
from teachpath_client.station import Station
from tests.ports import free_ports
from tests.waiting import HANG, wait_until

T = TypeVar("T")

# What is judged elsewhere: a tracker, an arm or a hand that gets no turn on a busy machine is silent or irregular.
BUSY_SETTINGS = {
    "TEACHPATH_RECORDING__LONGEST_GAP": "60",
    "TEACHPATH_RECORDING__LONGEST_SILENCE": "60",
    "TEACHPATH_RECORDING__TRACKER_RETURN_TIMEOUT": "300",
    "TEACHPATH_RECORDING__LARGEST_CLOCK_STEP": "60",
    "TEACHPATH_RECORDING__RATE_TOLERANCE": "1",
    "TEACHPATH_RECORDING__LONGEST_FREEZE": "60",
    "TEACHPATH_RECORDING__LOWEST_POSE_RATE": "0.1",
    "TEACHPATH_RECORDING__LARGEST_ACCELERATION": "1e6",
    "TEACHPATH_RECORDING__HANDSHAKE_TIMEOUT": "20",
    "TEACHPATH_EXECUTOR__SILENCE": "5",
    "TEACHPATH_EXECUTOR__SILENCE_TIMEOUT": "60",
    "TEACHPATH_EXECUTOR__SETPOINT_TIMEOUT": "5",
    "TEACHPATH_EXECUTOR__REST_TIMEOUT": "30",
    "TEACHPATH_EXECUTOR__HAND_SILENCE": "5",
    "TEACHPATH_EXECUTOR__HAND_RETURN_TIMEOUT": "60",
}
FAMILY = "SYSTEM_TEST_FAMILY"  # in the environment of a command and of all that it starts


class Command:
    """A running `teachpath ARGUMENTS` in a session of its own, as if in a terminal of its own.

    Args:
        folder: working folder; `tmp` in it becomes its folder of temporary files.
        under: the command that it is started by, as one that puts it into a namespace.
    """

    def __init__(
        self, *arguments: str, folder: Path, environment: dict[str, str] | None = None, under: Sequence[str] = ()
    ) -> None:
        self.family = uuid.uuid4().hex
        self.temporary = folder / "tmp"
        self.temporary.mkdir(parents=True, exist_ok=True)
        clean = {name: value for name, value in os.environ.items() if not name.startswith("TEACHPATH_")}
        self._out, self._err = (folder / f"{self.family}.{name}" for name in ("out", "err"))
        with self._out.open("wb") as out, self._err.open("wb") as err:
            self.process = subprocess.Popen(
                [*under, sys.executable, "-m", "teachpath", *arguments],
                env={**clean, "TMPDIR": str(self.temporary), FAMILY: self.family, **(environment or {})},
                cwd=folder,
                stdin=subprocess.DEVNULL,
                stdout=out,
                stderr=err,
                start_new_session=True,
            )

    @property
    def out(self) -> str:
        """What it printed so far."""
        return self._out.read_text()

    @property
    def err(self) -> str:
        """What it said on the error stream so far."""
        return self._err.read_text()

    def interrupt(self) -> None:
        """Press Ctrl-C: the terminal sends SIGINT to the whole foreground group."""
        os.killpg(self.process.pid, signal.SIGINT)

    def wait(self) -> int:
        """Return the exit status as soon as it has ended."""
        try:
            return self.process.wait(HANG)
        except subprocess.TimeoutExpired:
            raise AssertionError(f"still running after {HANG:g} s: {self.err[-2000:]}") from None

    def relatives(self) -> list[str]:
        """Return the command lines of all running processes that it or its children started, itself included."""
        return [command for _, command in family(self.family)]

    def find(self, words: str) -> list[int]:
        """Return the ids of the processes that it started and whose command line or `[name]` holds `words`."""
        return [pid for pid, command in family(self.family) if words in command]

    def wait_gone(self) -> None:
        """Wait until it and everything it started has ended."""
        wait_until(lambda: not self.relatives(), f"all ended, but for {self.relatives()}")

    def clean_up(self) -> None:
        """Kill what is left of it, so that a failed test harms no other."""
        for pid, _ in family(self.family):
            os.kill(pid, signal.SIGKILL)
        self.process.wait(HANG)


def family(name: str) -> list[tuple[int, str]]:
    """Return process ids and command lines of all that belong to a command, with their names: `COMMAND [NAME]`."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            if f"{FAMILY}={name}".encode() in (folder / "environ").read_bytes().split(b"\0"):
                command = (folder / "cmdline").read_bytes().replace(b"\0", b" ").decode()
                found.append((int(folder.name), f"{command}[{(folder / 'comm').read_text().strip()}]"))
        except OSError:  # it ended meanwhile, or belongs to somebody else
            continue
    return found


def stop_arm(station: Station, execution: str) -> Execution:
    """Stop an execution; on a busy machine the executor may confirm it later than a station waits for."""
    return confirmed(lambda: station.stop(execution))


def confirmed(stop: Callable[[], T]) -> T:
    """Stop again and again until that is confirmed, and return what a stop returns."""

    def stopped() -> T | None:
        with suppress(NotStopped):
            return stop()
        return None

    found = wait_until(stopped, "the executor confirms a stop")
    assert found is not None
    return found


def run(*arguments: str, folder: Path) -> Command:
    """Run a command to its end and return it."""
    command = Command(*arguments, folder=folder)
    try:
        command.wait()
    finally:
        command.clean_up()
    return command


class Service(Command):
    """A running `teachpath serve` on free ports; use it as a context manager.

    Args:
        data: its data folder.
        ports: of web and bus, to stand where another one stood; None: free ones.
        arguments: further ones of the command.
        settings: further TEACHPATH_* variables; else it has the patience of a busy machine.

    Attributes:
        station: the typed client of its REST API.
    """

    def __init__(
        self, data: Path, *, ports: tuple[int, int] | None = None, arguments: Sequence[str] = (), **settings: str
    ) -> None:
        self.data = data
        web, bus = self.ports = ports or free_ports(2)
        self.url, self.endpoint = f"http://127.0.0.1:{web}", f"tcp/127.0.0.1:{bus}"
        environment = {"TEACHPATH_BUS__ENDPOINT": self.endpoint, **BUSY_SETTINGS, **settings}
        words = ("serve", "--data", str(data), "--port", str(web), *arguments)
        super().__init__(*words, folder=data.parent, environment=environment)
        self.station = Station(self.url, timeout=HANG)

    def __enter__(self) -> "Service":
        try:
            wait_until(self._answers, f"the service answers; it says {self.err}")
        except BaseException:
            self.clean_up()
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.station.__exit__()
        try:
            if self.process.poll() is None:
                self.process.terminate()
                assert self.wait() == 0
            self.wait_gone()
            assert "Traceback" not in self.err, self.err
        finally:
            self.clean_up()

    def kill(self) -> None:
        """End the service as a crash does; its other processes must leave by themselves."""
        self.process.kill()
        self.process.wait(HANG)

    def _answers(self) -> bool:
        assert self.process.poll() is None, self.err
        try:
            return httpx.get(f"{self.url}/api/v1/health/live", timeout=HANG, trust_env=False).is_success
        except httpx.TransportError:
            return False
