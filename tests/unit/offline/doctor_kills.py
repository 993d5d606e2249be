"""Doctors that are killed: `python -m tests.unit.offline.doctor_kills FOLDER COUNT SEED`.

Every doctor works on a data folder with a fault of each kind, every other one without its database; it dies just before
one of its accesses to files and rows, chosen at random, without another statement. Doctors go on dying until one lives,
at most three times. Prints one line of JSON: how often one was killed, and what is wrong afterwards in which trial.
"""

from __future__ import annotations

import json
import os
import random
import shutil
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path

from sqlalchemy import event
from sqlalchemy.engine import Engine

from tests.unit.offline.damage import contradictions, drop_row, examined, file_of, flip, make_station, rows_of

WATCHED_CALLS = ("open", "os.rename", "os.remove", "os.mkdir", "os.rmdir")
MAX_DEATHS = 3
KILLED_STATUS = 9


def make_damage(data: Path) -> None:
    """Make a station with five demonstrations and a torn one, and damage what can be mended."""
    rows = make_station(data, 5, torn=100)
    moved, doubled, shortened = (file_of(data, row) for row in rows[:3])
    moved.rename(moved.with_name("moved.mcap"))
    shutil.copy(doubled, doubled.with_name("demo-9.mcap"))
    flip(shortened, shortened.stat().st_size - 30)
    (data / "repairs").mkdir()
    (data / "repairs" / "half").write_text("half")
    drop_row(data, rows[-1].id)


def content_of(data: Path) -> dict[str, object]:
    """Return what must be the same however often a doctor was killed: rows, and the names of files."""
    rows = {row.id: (row.number, row.samples, row.verdict, row.grasp, row.release) for row in rows_of(data)}
    files = sorted(file.relative_to(data).as_posix() for file in (data / "recordings").rglob("*") if file.is_file())
    numbers = {row.id: row.digest and (row.digest.samples, row.digest.first, row.digest.last) for row in rows_of(data)}
    return {"rows": rows, "files": files, "numbers": numbers}


def in_child(work: Callable[[], None]) -> int:
    """Return the exit status of a process that does the work."""
    if (pid := os.fork()) == 0:
        try:
            work()
        except BaseException:
            os._exit(2)
        os._exit(0)
    return os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])


def examine_and_die(data: Path, die_at: int, told: int) -> None:
    """Run a doctor that dies at an access; one that lives tells how many there were."""
    seen = 0

    def note(*_: object, **__: object) -> None:
        nonlocal seen
        seen += 1
        if seen == die_at:
            os._exit(KILLED_STATUS)

    sys.addaudithook(lambda name, _: note() if name in WATCHED_CALLS else None)
    event.listen(Engine, "before_cursor_execute", note)
    event.listen(Engine, "commit", note)
    examined(data)
    os.write(told, str(seen).encode())


def trial(data: Path, template: Path, chance: random.Random, accesses: int) -> tuple[int, list[str]]:
    """Let doctors die over a folder; return how many, and what is wrong after one has lived."""
    shutil.rmtree(data, ignore_errors=True)
    shutil.copytree(template, data)
    deaths, silent = 0, os.open(os.devnull, os.O_WRONLY)
    while deaths < MAX_DEATHS:
        if in_child(partial(examine_and_die, data, chance.randint(1, accesses), silent)) != KILLED_STATUS:
            break
        deaths += 1
    os.close(silent)
    first, second = examined(data), examined(data)
    return deaths, [f.sentence for f in first if not f.mended] + [f.sentence for f in second] + contradictions(data)


def main(root: Path, count: int, seed: int) -> dict[str, object]:
    """Make the trials and return what came of them."""
    chance = random.Random(seed)
    cases: list[tuple[Path, int, dict[str, object]]] = []
    for name in ("with", "without"):
        template, mended = root / name, root / f"{name}-mended"
        make_damage(template)
        if name == "without":
            for file in template.glob("teachpath.sqlite*"):
                file.unlink()
        shutil.copytree(template, mended)
        reading, writing = os.pipe()
        in_child(partial(examine_and_die, mended, 0, writing))
        cases.append((template, int(os.read(reading, 64)), content_of(mended)))
    killed, wrong = 0, {}
    for number in range(count):
        template, accesses, expected = cases[number % 2]
        deaths, found = trial(root / "trial", template, chance, accesses)
        killed += deaths
        if content_of(root / "trial") != expected:
            found.append("rows or files are others than without a kill")
        if found:
            wrong[number] = found
    return {"killed": killed, "accesses": [accesses for _, accesses, _ in cases], "wrong": wrong}


if __name__ == "__main__":
    print(json.dumps(main(Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3]))))
