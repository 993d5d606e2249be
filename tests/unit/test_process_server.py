"""The server of working processes starts wherever temporary files are."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from teachpath.process_server import MAX_FOLDER
from tests.waiting import HANG

SERVER = """
import tempfile
from teachpath.process_server import CONTEXT, start_process_server
if __name__ == "__main__":
    start_process_server([])
    process = CONTEXT.Process(target=print, args=("works",))
    process.start()
    process.join()
    print(tempfile.gettempdir())
"""
POOL = """
import tempfile
from teachpath.jobs.limited_process import LimitedProcess
from teachpath.jobs.settings import JobSettings
if __name__ == "__main__":
    process = LimitedProcess(JobSettings())
    print(process.call(str.strip, " works "))
    process.stop()
    print(tempfile.gettempdir())
"""


@pytest.mark.parametrize("text", [SERVER, POOL], ids=["server", "pool"])
def test_it_starts_where_the_path_of_temporary_files_is_long(tmp_path: Path, text: str) -> None:
    folder = tmp_path / ("x" * MAX_FOLDER)
    folder.mkdir()
    program = tmp_path / "program.py"
    program.write_text(text)
    command = [sys.executable, str(program)]
    done = subprocess.run(
        command, capture_output=True, text=True, timeout=HANG, env={**os.environ, "TMPDIR": str(folder)}, check=False
    )
    assert (done.returncode, done.stdout) == (0, f"works\n{folder}\n"), done.stderr
    assert list(folder.iterdir()) == []
