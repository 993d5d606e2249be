"""A program that is a service of its own, and the runs that it has made."""

import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from teachpath.io.store.pages import PageRequest
from teachpath.io.store.store import Store
from teachpath.records import RunSummary


@contextmanager
def a_program(url: str, folder: Path) -> Iterator[tuple[subprocess.Popen[str], str]]:
    command = [sys.executable, "-m", "tests.contract.job_program", url, str(folder)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            yield process, process.stdout.readline().strip()
        finally:
            process.kill()


def every_run(store: Store) -> list[RunSummary]:
    return store.lists.runs("t", PageRequest(limit=500)).entries
