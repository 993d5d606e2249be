"""Control of the arm that lasts as long as the program that took it."""

from __future__ import annotations

import threading
from collections.abc import Callable
from contextlib import suppress
from typing import Final

from teachpath_client.errors import ClientError, Refused, Unreachable
from teachpath_client.work_resources import WorkResources

LEASE_DURATION: Final = 3.0  # [s] after the last beat; then control is lost, and a moving arm is held on its path
BEAT_INTERVAL: Final = 0.5  # [s]


class ControlKeeper:
    """Takes control of the arm, keeps it by beats on a thread of its own, and gives it to whoever asks for it.

    Control that lapsed because the beats were late is taken again, unless somebody else has it by then.

    Args:
        url: of the station.
        name: under which everybody sees who is in control.
        on_token: called with the token of each lease, and with an empty one when control is lost.
        token: that says who you are, where the station asks.
    """

    def __init__(self, url: str, name: str, on_token: Callable[[str], object], *, token: str = "") -> None:
        self._rest = WorkResources(url, timeout=LEASE_DURATION, token=token)
        self._name = name
        self._on_token = on_token
        self._stopping = threading.Event()
        self._thread = threading.Thread(target=self._keep, name="control", daemon=True)

    def start(self) -> None:
        """Take control; raises Refused when somebody else has it or the executor does not answer."""
        try:
            self._acquire()
        except ClientError:
            self._rest.__exit__()
            raise
        self._thread.start()

    def stop(self) -> None:
        """Give control back."""
        self._end()
        with suppress(ClientError):  # it is lost already, or lapses
            self._release()
        self._rest.__exit__()

    def abandon(self) -> None:
        """Send no more beats, so that control lapses and an arm that moves then is held."""
        self._end()
        self._on_token("")
        self._rest.__exit__()

    def _end(self) -> None:
        self._stopping.set()
        self._thread.join()

    def _acquire(self) -> None:
        lease = self._rest.claim_lease(self._name, seconds=LEASE_DURATION, hold_when_lost=True)
        self._set_token(lease.token)

    def _release(self) -> None:
        self._rest.act_on_lease("release")
        self._set_token("")

    def _set_token(self, token: str) -> None:
        self._rest.set_lease(token)
        self._on_token(token)

    def _keep(self) -> None:
        while not self._stopping.wait(BEAT_INTERVAL):
            with suppress(Unreachable):  # the station may answer the next beat
                try:
                    if self._rest.act_on_lease("beat").asking:
                        self._release()
                        return
                except Refused as refused:
                    if refused.refusal.error == "Conflict" and not self._acquire_again():
                        return

    def _acquire_again(self) -> bool:
        """Take control that lapsed or was handed over, and return whether nobody else has it."""
        try:
            self._acquire()
        except Refused:
            self._set_token("")
            return False
        return True
