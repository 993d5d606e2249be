"""The processes beside the service, executor and simulated arm: they start with it and never outlive it."""

from __future__ import annotations

import contextlib
import signal
import subprocess
import sys
import threading
from collections import deque

STOP_TIMEOUT = 1.5  # [s] that a process may take to end before it is killed


class WorkerProcess:
    """`teachpath <name> --attached`: reads its settings from its standard input, and ends when that is closed."""

    def __init__(self, name: str, settings: str) -> None:
        """Prepare the process `name`; `settings` is the whole tree in JSON, on one line."""
        self.name = name
        self._settings = settings
        self._process: subprocess.Popen[str] | None = None
        self._lines: deque[str] = deque(maxlen=20)

    def start(self) -> None:
        """Start the process; it is ready when it announces itself on the bus."""
        self._process = subprocess.Popen(
            [sys.executable, "-m", "teachpath", self.name, "--attached"],
            stdin=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            # its own session: Ctrl-C goes to the service alone, which then stops its parts in order
            start_new_session=True,
        )
        assert self._process.stdin is not None
        self._process.stdin.write(self._settings + "\n")
        self._process.stdin.flush()
        threading.Thread(target=self._read_stderr, name=f"{self.name} stderr", daemon=True).start()

    def is_alive(self) -> bool:
        """Tell whether the process runs."""
        return self._process is not None and self._process.poll() is None

    def last_error(self) -> str:
        """Return the last line the process wrote, or its exit status."""
        code = self._process.poll() if self._process else None
        return self._lines[-1] if self._lines else f"exit status {code}"

    def request_stop(self) -> None:
        """Ask the process to end by itself."""
        if self._process is not None and self._process.poll() is None:
            self._process.send_signal(signal.SIGTERM)

    def stop(self) -> None:
        """End the process; it is killed when it does not end in time."""
        if self._process is None:
            return
        self.request_stop()
        with contextlib.suppress(OSError):
            self._process.stdin.close()  # type: ignore[union-attr]
        try:
            self._process.wait(STOP_TIMEOUT)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()

    def _read_stderr(self) -> None:
        assert self._process is not None
        assert self._process.stderr is not None
        for line in self._process.stderr:
            self._lines.append(line.strip())
            sys.stderr.write(f"{self.name}: {line}")
