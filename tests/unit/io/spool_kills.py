"""Spools that are killed: `python -m tests.unit.io.spool_kills FOLDER`, with object storage in the environment.

Each one dies just before one of its accesses to files and rows, at every one of them in turn, without another
statement: between a recording's end, its upload, its row and its removal. After every other one a doctor goes first.
Prints one line of JSON: at how many accesses one was killed, and what is wrong afterwards in which trial.
"""

from __future__ import annotations

import json
import os
import shutil
import sys
from functools import partial
from itertools import count
from pathlib import Path

from sqlalchemy import event
from sqlalchemy.engine import Engine

from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.offline.doctor import examine
from tests.object_storage import BUCKET
from tests.unit.io.spools import upload
from tests.unit.offline.damage import SETTINGS, TASK, make_station
from tests.unit.offline.doctor_kills import KILLED_STATUS, in_child

WATCHED_CALLS = ("open", "os.remove")


def of(data: Path, url: str) -> StoreSettings:
    return StoreSettings(str(data), recordings=url)


def upload_and_die(data: Path, url: str, die_at: int) -> None:
    seen = count(1)

    def note(*_: object, **__: object) -> None:
        if next(seen) == die_at:
            os._exit(KILLED_STATUS)

    sys.addaudithook(lambda name, _: note() if name in WATCHED_CALLS else None)
    event.listen(Engine, "before_cursor_execute", note)
    event.listen(Engine, "commit", note)
    upload(of(data, url))


def check(data: Path, url: str, told: int, *, with_doctor: bool) -> None:
    """Go on after a kill, and tell what is wrong then."""
    store = Store(of(data, url))
    found = []
    if with_doctor:
        found += [each.sentence for each in examine(store, SETTINGS, {}, data) if not each.mended]
    upload(of(data, url))
    found += [each.sentence for each in examine(store, SETTINGS, {}, data)]
    rows, read = store.demonstrations(TASK), store.recordings.samples
    found += [row.id for row in rows if len(read(row.recording, row.digest)) != row.samples]
    found += [row.recording for row in rows if not row.recording.startswith(url)]
    found += [file.name for file in store.recordings.finished()]
    found += [f"{len(rows)} rows"] * (len(rows) != 1)
    os.write(told, json.dumps(found).encode())
    store.close()


def main(root: Path) -> dict[str, object]:
    """Make the trials and return what came of them."""
    make_station(root / "template", 1)
    wrong: dict[int, list[str]] = {}
    for number in count(1):
        data, url = root / "trial", f"s3://{BUCKET}/{root.name}-{number}"
        shutil.rmtree(data, ignore_errors=True)
        shutil.copytree(root / "template", data)
        code = in_child(partial(upload_and_die, data, url, number))
        reading, writing = os.pipe()
        checked = in_child(partial(check, data, url, writing, with_doctor=number % 2 == 0))
        os.close(writing)
        found = json.loads(os.read(reading, 65536) or b'["the check failed"]')
        os.close(reading)
        if found or checked:
            wrong[number] = found
        if code != KILLED_STATUS:
            return {"killed": number - 1, "wrong": wrong}
    raise AssertionError


if __name__ == "__main__":
    print(json.dumps(main(Path(sys.argv[1]))))
