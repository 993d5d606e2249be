"""A station whose small disk is full, then read-only, and whose database somebody locks: FOLDER.

Run where it may mount, as root or in a name space of its own. Prints one line of JSON: by trouble, what REST answered
to a request that writes, what health said meanwhile, and what it answered and said afterwards.
"""

from __future__ import annotations

import asyncio
import json
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from tests.contract import stations
from tests.contract.desk import Desk, csv
from tests.waiting import wait_until

SIZE = "1m"
LOCK = """
import sqlite3, sys
database = sqlite3.connect(sys.argv[1])
database.execute("BEGIN EXCLUSIVE")
print("locked", flush=True)
sys.stdin.read()
"""


def mount(disk: Path, options: str) -> None:
    subprocess.run(["mount", "-t", "tmpfs", "-o", options, "none", str(disk)], check=True)


@contextmanager
def full(disk: Path) -> Iterator[None]:
    filler = disk / "filler"
    with filler.open("wb", buffering=0) as file, suppress(OSError):
        while file.write(bytes(512)):
            pass
    yield
    filler.unlink()


@contextmanager
def locked(disk: Path) -> Iterator[None]:
    command = [sys.executable, "-c", LOCK, str(disk / "teachpath.sqlite")]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as locker:
        assert locker.stdout is not None
        assert locker.stdin is not None
        locker.stdout.readline()
        yield
        locker.stdin.close()


def tried(desk: Desk, disk: Path, number: int) -> dict[str, Any]:
    """Ask for what writes a row, and for what writes a file, and read what health says."""
    answers = [
        desk.put(f"/tasks/new-{number}", {"scene": "paper", "calibration": "identity"}),
        desk.upload(f"imported-{number}", csv()),
    ]
    said = [[answer.status_code, answer.json().get("detail", "")] for answer in answers]
    return {"answers": said, "notes": desk.get("/health").json()["notes"]}


def main(disk: Path) -> dict[str, Any]:
    """Make the troubles one after another."""
    mount(disk, f"size={SIZE}")
    told: dict[str, Any] = {}
    with stations.station_in(disk) as station, asyncio.Runner() as loop:
        desk = Desk(station, loop)
        troubles = {"full": full, "locked": locked}
        for number, (name, trouble) in enumerate(troubles.items()):
            with trouble(disk):
                wait_until(lambda: desk.get("/health").json()["notes"], f"health says that it is {name}")
                told[name] = tried(desk, disk, number)
            wait_until(lambda: not desk.get("/health").json()["notes"], f"health says no more that it is {name}")
            (job,) = [desk.upload(f"after-{number}", csv())]
            told[name]["after"] = desk.ended(job)["state"]
            told[name]["left"] = [file.name for file in disk.rglob("*.temporary")]
    subprocess.run(["umount", str(disk)], check=True)
    return told


if __name__ == "__main__":
    print(json.dumps(main(Path(sys.argv[1]))))
