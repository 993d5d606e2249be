"""The server that executor, simulated arm and processes of jobs are forked from: what it has loaded, none has to load.

It forks because loading the libraries of learning and planning takes a second or two of a processor, at each start, for
the first job, and for the one after a job that was ended with its process. It runs no thread, so that a fork of it is
sound.
"""

from __future__ import annotations

import os
import signal
import tempfile
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from multiprocessing import forkserver, get_context, resource_tracker
from typing import Final

CONTEXT: Final = get_context("forkserver")
MAX_FOLDER: Final = 60  # bytes of a path; a socket's has at most 103, with a folder and a name of multiprocessing's own
_ONE_START: Final = threading.Lock()  # at a time: the folder of temporary files is the process's
FOLDERS: Final = ("/tmp", "/var/tmp", "/dev/shm")


def start_process_server(modules: Sequence[str]) -> None:
    """Start the server, unless it runs, and return while it loads modules; processes that are asked for wait for it."""
    CONTEXT.set_forkserver_preload(list(modules))
    with process_start():
        forkserver.ensure_running()


@contextmanager
def process_start() -> Iterator[None]:
    """Start processes in this context, the server too.

    They never see Ctrl-C, which goes to all of a terminal before they can ignore it; and the server's socket lies where
    its path is short enough for the system, also where TMPDIR is not.
    """
    with _ONE_START:
        resource_tracker.ensure_running()  # which, where it begins, lets this thread see Ctrl-C again
        before, folder = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT}), tempfile.tempdir
        if len(os.fsencode(tempfile.gettempdir())) > MAX_FOLDER:
            tempfile.tempdir = next((short for short in FOLDERS if os.access(short, os.W_OK | os.X_OK)), folder)
        try:
            yield
        finally:
            tempfile.tempdir = folder
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
