"""A PostgreSQL server for tests, from Debian's packages: on a socket in a temporary folder, and on no port."""

from __future__ import annotations

import itertools
import os
import pwd
import shutil
import signal
import subprocess
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from sqlalchemy import create_engine, make_url, text

from teachpath.io.store.engine import open_engine
from tests.waiting import HANG

NO_POSTGRESQL = (
    "PostgreSQL is not there; get it with: apt-get install postgresql, and pip install 'teachpath[postgres]'"
)
USER, TEMPLATE = "teachpath", "with_tables"
ROOM = 4 * 2**30  # bytes that must be free in memory for its files


def find_programs() -> Path | None:
    """Return the folder of the newest server's programs; None: there is none."""
    folders = sorted(Path("/usr/lib/postgresql").glob("*/bin"), key=lambda folder: int(folder.parent.name))
    found = shutil.which("postgres")
    return folders[-1] if folders else Path(found).resolve().parent if found else None


class Server:
    """A server, which makes an empty database for whoever asks."""

    def __init__(self, programs: Path, folder: Path, options: dict[str, Any]) -> None:
        self._programs, self._folder, self._options = programs, folder, options
        self._numbers = itertools.count(1)
        self._process: subprocess.Popen[bytes] | None = None

    def make(self) -> None:
        """Make its files."""
        made = self.run("initdb", "-D", self._data, "-U", USER, "-A", "trust", "-E", "UTF8", "--no-sync")
        assert made.returncode == 0, made.stderr

    def start(self) -> None:
        """Start it, and wait until it accepts connections."""
        command = [str(self._programs / "postgres"), "-D", self._data]
        for setting in ("listen_addresses=", f"unix_socket_directories={self._folder}", "fsync=off"):
            command += ["-c", setting]
        log = self._folder / "log"
        with log.open("a") as file:
            self._process = process = subprocess.Popen(command, stdout=file, stderr=file, **self._options)
        deadline = time.monotonic() + HANG
        while not self.is_ready():
            assert process.poll() is None, log.read_text()
            assert time.monotonic() < deadline, "the server does not begin to answer"
            time.sleep(0.05)

    def stop(self, how: signal.Signals = signal.SIGINT) -> None:
        """End its sessions, then itself; by SIGQUIT it leaves everything as a crash would."""
        if self._process is not None:
            self._process.send_signal(how)
            self._process.wait(HANG)
            self._process = None

    def run(self, program: str, *words: str) -> subprocess.CompletedProcess[str]:
        """Run one of the server's programs as its user."""
        command = [str(self._programs / program), *words]
        return subprocess.run(command, capture_output=True, text=True, timeout=HANG, check=False, **self._options)

    def new_url(self, *, tables: bool = True) -> str:
        """Make a database with the newest tables and no rows, or without tables, and return its address."""
        number = next(self._numbers)
        name = f"t{number}"
        if number == 1:
            self._make_database(TEMPLATE, "template0")
            open_engine(self._url(TEMPLATE)).dispose()
        self._make_database(name, TEMPLATE if tables else "template0")
        return self._url(name)

    def drop(self, url: str) -> None:
        """Remove a database, whoever is still connected to it."""
        self._administer(f"DROP DATABASE {make_url(url).database} WITH (FORCE)")

    def cut_lines(self) -> None:
        """Break every connection but the one that asks for it."""
        self._administer("SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE pid <> pg_backend_pid()")

    @property
    def socket(self) -> str:
        """The file of the socket at which it listens."""
        return str(self._folder / ".s.PGSQL.5432")

    def _make_database(self, name: str, template: str) -> None:
        self._administer(f"CREATE DATABASE {name} TEMPLATE {template} STRATEGY file_copy")

    def _administer(self, statement: str) -> None:
        admin = create_engine(self._url("postgres"), isolation_level="AUTOCOMMIT")
        with admin.connect() as connection:
            connection.execute(text(statement))
        admin.dispose()

    @property
    def _data(self) -> str:
        return str(self._folder / "data")

    def _url(self, name: str) -> str:
        return f"postgresql+psycopg://{USER}@/{name}?host={self._folder}"

    def is_ready(self) -> bool:
        """Whether it accepts connections."""
        return self.run("pg_isready", "-h", str(self._folder), "-U", USER).returncode == 0


@contextmanager
def serving() -> Iterator[Server]:
    """Start a server; as it refuses to run as root, root starts it as the user that Debian made for it."""
    programs = find_programs()
    assert programs is not None
    memory = Path("/dev/shm")  # where its files cost the disk nothing
    roomy = memory.is_dir() and shutil.disk_usage(memory).free > ROOM
    folder = Path(tempfile.mkdtemp(prefix="tp-pg-", dir=memory if roomy else None))
    options: dict[str, Any] = {"cwd": folder}
    if os.geteuid() == 0:
        user = pwd.getpwnam("postgres")
        os.chown(folder, user.pw_uid, user.pw_gid)
        options |= {"user": user.pw_uid, "group": user.pw_gid, "extra_groups": []}
    server = Server(programs, folder, options)
    try:
        server.make()
        server.start()
        yield server
    finally:
        server.stop(signal.SIGQUIT)  # nobody needs its files any more
        shutil.rmtree(folder, ignore_errors=True)
