"""What the machine has for a station and for the tests, what it lacks, and how to get it."""

from __future__ import annotations

import os
import shutil
import socket
import statistics
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from teachpath.realtime import ADVICE, EXECUTOR_PRIORITY, set_fifo

LEAST_CORES: Final = 2  # the executor's loop has one while learning uses the other
LEAST_MEMORY: Final = 1.5e9  # bytes available: the service, its processes, and a worker that learns
LEAST_DISK: Final = 1e9  # bytes free: some ten thousand demonstrations
LONGEST_OVERSLEEP: Final = 0.01  # [s] of a sleep of one control period; the player follows a way to rest after 0.03
SLEEPS: Final = 100
BROWSERS: Final = ("chromium", "chromium-browser", "google-chrome")


@dataclass(frozen=True, slots=True)
class SystemFinding:
    """What was looked at on the machine.

    Attributes:
        name: of it.
        sentence: what was found; where something is lacking, what follows and how to get it.
        lacking: whether a station cannot run, or not well, as it is.
        needed_by: `station`, or `tests` where only `make test` needs it.
    """

    name: str
    sentence: str
    lacking: bool = False
    needed_by: str = "station"


def examine_system(
    data: Path, ports: Iterable[tuple[str, str, int]], running: Sequence[str]
) -> Iterator[SystemFinding]:
    """Yield what a station finds on this machine.

    Args:
        data: folder where it keeps its data; it may not exist yet.
        ports: setting, host and TCP port of each that it listens on.
        running: addresses of the services of this user that run.
    """
    yield judge_cores(len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1)
    if (memory := _available_memory()) is not None:
        yield judge_memory(memory)
    yield judge_disk(data, shutil.disk_usage(_nearest(data)).free)
    yield judge_realtime(_refused_realtime())
    yield judge_sleeps(_oversleeps(0.004))
    for setting, host, port in ports:
        yield judge_port(setting, host, port, free=_is_free(host, port), running=running)
    yield judge_browser(next((found for name in BROWSERS if (found := shutil.which(name))), ""))
    yield judge_nginx(shutil.which("nginx", path=f"{os.environ.get('PATH', '')}:/usr/sbin") or "")


def judge_cores(count: int) -> SystemFinding:
    """Judge the number of cores that this process may use."""
    if count >= LEAST_CORES:
        return SystemFinding("cores", f"{count} cores")
    return SystemFinding(
        "cores",
        f"{count} core, and {LEAST_CORES} are wanted: while a path is learned, setpoints come late and the arm waits "
        "for them; learn while nothing moves, or give the machine another core",
        lacking=True,
    )


def judge_memory(available: float) -> SystemFinding:
    """Judge the available memory [bytes]."""
    if available >= LEAST_MEMORY:
        return SystemFinding("memory", f"{available / 1e9:.1f} GB available")
    return SystemFinding(
        "memory",
        f"{available / 1e9:.1f} GB available, and {LEAST_MEMORY / 1e9:g} GB are wanted: large jobs are ended; end "
        "other programs, or set jobs.max_memory lower",
        lacking=True,
    )


def judge_disk(data: Path, free: float) -> SystemFinding:
    """Judge the free space [bytes] of the disk of the data folder."""
    if free >= LEAST_DISK:
        return SystemFinding("disk", f"{free / 1e9:.0f} GB free for {data}")
    return SystemFinding(
        "disk",
        f"{free / 1e9:.2f} GB free for {data}, and {LEAST_DISK / 1e9:g} GB are wanted: takes that do not fit are not "
        "kept; free space, or set store.data_dir to a folder of another disk",
        lacking=True,
    )


def judge_realtime(refused: str) -> SystemFinding:
    """Judge why real-time scheduling was refused; empty: it was granted."""
    if not refused:
        return SystemFinding("real-time scheduling", f"SCHED_FIFO {EXECUTOR_PRIORITY} is granted")
    return SystemFinding(
        "real-time scheduling",
        f"refused ({refused}): on a busy machine setpoints come late and the arm waits for them; "
        f"{ADVICE.format(EXECUTOR_PRIORITY)}, then log in again",
        lacking=True,
    )


def judge_sleeps(oversleeps: Sequence[float]) -> SystemFinding:
    """Judge how much longer than asked sleeps of one control period took [s]."""
    median, worst = statistics.median(oversleeps), max(oversleeps)
    sentence = f"sleeps of 4 ms end {1e3 * median:.2f} ms late, {1e3 * worst:.1f} at worst"
    if worst <= LONGEST_OVERSLEEP:
        return SystemFinding("timer", sentence)
    return SystemFinding(
        "timer",
        f"{sentence}: setpoints come late; end what else runs, allow real-time scheduling, or leave a virtual machine",
        lacking=True,
    )


def judge_port(setting: str, host: str, port: int, *, free: bool, running: Sequence[str]) -> SystemFinding:
    """Judge a port that the station listens on."""
    if free:
        return SystemFinding(f"port {port}", f"{host}:{port} is free ({setting})")
    if running:
        return SystemFinding(f"port {port}", f"{host}:{port} is in use ({setting}); your service runs: {running[0]}")
    return SystemFinding(
        f"port {port}",
        f"{host}:{port} is in use, and none of your services runs: end the program that listens there (ss -ltnp), or "
        f"set {setting} to another port",
        lacking=True,
    )


def judge_browser(found: str) -> SystemFinding:
    """Judge the Chromium that the tests look at the page with."""
    return _judge_program("Chromium", found, "the browser tests are left out", "apt-get install chromium")


def judge_nginx(found: str) -> SystemFinding:
    """Judge the nginx that the tests put before the page."""
    return _judge_program("nginx", found, "the tests behind a proxy are left out", "apt-get install nginx-light")


def _judge_program(name: str, found: str, consequence: str, command: str) -> SystemFinding:
    if found:
        return SystemFinding(name, found, needed_by="tests")
    return SystemFinding(
        name, f"not found: {consequence}; get it with: sudo {command}", lacking=True, needed_by="tests"
    )


def _available_memory() -> float | None:
    try:
        lines = Path("/proc/meminfo").read_text().splitlines()
        return next(1024.0 * int(line.split()[1]) for line in lines if line.startswith("MemAvailable:"))
    except (OSError, StopIteration, ValueError):
        return None


def _nearest(folder: Path) -> Path:
    """Return a folder, or the nearest above it that exists."""
    return next(each for each in (folder.absolute(), *folder.absolute().parents) if each.exists())


def _refused_realtime() -> str:
    """Return why the system refuses real-time scheduling; asked in a thread, which ends with what it was granted."""
    said: list[str] = []

    def ask() -> None:
        """Ask for real-time scheduling, and keep why it is refused."""
        try:
            set_fifo(EXECUTOR_PRIORITY)
            said.append("")
        except AttributeError:
            said.append("this system has none")
        except OSError as error:
            said.append(error.strerror or str(error))

    _in_thread(ask)
    return said[0]


def _oversleeps(period: float) -> list[float]:
    """Return how much longer than asked each of some sleeps took [s], as the executor's thread would sleep."""
    late: list[float] = []

    def sleep() -> None:
        for _ in range(SLEEPS):
            begun = time.perf_counter()
            time.sleep(period)
            late.append(time.perf_counter() - begun - period)

    _in_thread(sleep)
    return late


def _in_thread(work: Callable[[], None]) -> None:
    thread = threading.Thread(target=work)
    thread.start()
    thread.join()


def _is_free(host: str, port: int) -> bool:
    try:
        socket.create_server((host, port)).close()
    except OSError:
        return False
    return True
