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

from sqlalchemy import create_engine, text

from teachpath.io.store.engine import open_engine
from tests.waiting import HANG

MISSING = "PostgreSQL is not there; get it with: apt-get install postgresql, and pip install 'teachpath[postgres]'"
USER, TEMPLATE = "teachpath", "with_tables"


def find_programs() -> Path | None:
    """Return the folder of the newest server's programs; None: there is none."""
    folders = sorted(Path("/usr/lib/postgresql").glob("*/bin"), key=lambda folder: int(folder.parent.name))
    found = shutil.which("postgres")
    return folders[-1] if folders else Path(found).resolve().parent if found else None


class Server:
    """A running server, which makes an empty database for whoever asks."""

    def __init__(self, programs: Path, folder: Path, options: dict[str, Any]) -> None:
        self._programs, self._folder, self._options = programs, folder, options
        self._numbers = itertools.count(1)

    def run(self, program: str, *words: str) -> subprocess.CompletedProcess[str]:
        """Run one of the server's programs as its user."""
        command = [str(self._programs / program), *words]
        return subprocess.run(command, capture_output=True, text=True, timeout=HANG, check=False, **self._options)

    def new_url(self) -> str:
        """Make a database with the newest tables and no rows, and return its address."""
        name = f"t{next(self._numbers)}"
        if name == "t1":
            self._make_database(TEMPLATE, "template0")
            open_engine(self._url(TEMPLATE)).dispose()
        self._make_database(name, TEMPLATE)
        return self._url(name)

    def _make_database(self, name: str, template: str) -> None:
        admin = create_engine(self._url("postgres"), isolation_level="AUTOCOMMIT")
        with admin.connect() as connection:
            connection.execute(text(f"CREATE DATABASE {name} TEMPLATE {template} STRATEGY file_copy"))
        admin.dispose()

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
    folder = Path(tempfile.mkdtemp(prefix="tp-pg-"))
    options: dict[str, Any] = {"cwd": folder}
    if os.geteuid() == 0:
        user = pwd.getpwnam("postgres")
        os.chown(folder, user.pw_uid, user.pw_gid)
        options |= {"user": user.pw_uid, "group": user.pw_gid, "extra_groups": []}
    server, data = Server(programs, folder, options), str(folder / "data")
    try:
        made = server.run("initdb", "-D", data, "-U", USER, "-A", "trust", "-E", "UTF8", "--no-sync")
        assert made.returncode == 0, made.stderr
        command = [str(programs / "postgres"), "-D", data]
        for setting in ("listen_addresses=", f"unix_socket_directories={folder}", "fsync=off"):
            command += ["-c", setting]
        with (folder / "log").open("w") as log, subprocess.Popen(command, stdout=log, stderr=log, **options) as process:
            try:
                deadline = time.monotonic() + HANG
                while not server.is_ready():
                    assert process.poll() is None, (folder / "log").read_text()
                    assert time.monotonic() < deadline, "the server does not begin to answer"
                    time.sleep(0.05)
                yield server
            finally:
                process.send_signal(signal.SIGINT)  # ends its sessions, then itself
                process.wait(HANG)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
