"""The link to a station: a Zenoh client session that meets nobody but the named endpoint."""

from __future__ import annotations

import json
import socket
from collections.abc import Callable
from pathlib import Path
from typing import Any

import zenoh
import zenoh.ext

from teachpath_client.errors import ClientError
from teachpath_proto.logins import Login, Role, find_login, logins_path, read_logins
from teachpath_proto.sessions import joining, open_session

CACHE_SIZE = 1024  # samples that a subscriber which missed some can still ask for
HEARTBEAT = 0.2  # [s] after a put until a subscriber is told its number, so that a lost last one is missed too


class Link:
    """A session with one station; use it as a context manager.

    Args:
        endpoint: where the station listens.
        role: what this program does there; its login is this user's for that role.
        login: another login, as `teachpath login create` gave it.
        timeout: [s] to connect in.

    Raises:
        ClientError: nobody listens at `endpoint`, or it does not know the login.
    """

    def __init__(
        self, endpoint: str, *, role: Role = Role.TRACKER, login: Login | None = None, timeout: float = 10.0
    ) -> None:
        try:
            found = login or find_login(endpoint, role)
        except ValueError as error:
            raise ClientError(str(error)) from None
        try:
            self._session = open_session(joining(endpoint, found, timeout=timeout))
        except zenoh.ZError as error:
            # Logins outlast their station; who listens there now may ask for none, and refuses whoever shows one.
            session = _open_without_login(endpoint, timeout) if found is not login else None
            if session is None:
                raise ClientError(_unreachable(endpoint, role, found, error)) from error
            self._session = session
        self._publishers: list[zenoh.ext.AdvancedPublisher] = []

    def __enter__(self) -> Link:
        return self

    def __exit__(self, *_: object) -> None:
        # A session that closes under a publisher's heartbeat may keep the process from ending.
        for publisher in self._publishers:
            publisher.undeclare()  # type: ignore[no-untyped-call]
        self._publishers.clear()
        self._session.close()  # type: ignore[no-untyped-call]

    def publisher(self, key: str) -> Any:
        """Return a publisher on `key` that blocks instead of dropping, and repeats samples that a subscriber missed."""
        publisher = zenoh.ext.declare_advanced_publisher(
            self._session,
            key,
            congestion_control=zenoh.CongestionControl.BLOCK,
            cache=zenoh.ext.CacheConfig(CACHE_SIZE),
            sample_miss_detection=zenoh.ext.MissDetectionConfig(heartbeat=None, sporadic_heartbeat=HEARTBEAT),
        )
        self._publishers.append(publisher)
        return publisher

    def subscribe(self, key: str, receive: Callable[[bytes], object]) -> Any:
        """Call `receive` with all that is published on `key`; it runs on Zenoh's thread and should only append."""
        return self._session.declare_subscriber(key, lambda sample: receive(sample.payload.to_bytes()))

    def put(self, key: str, payload: bytes) -> None:
        """Publish once on `key`, ahead of all that waits; where the line is full it is dropped."""
        self._session.put(key, payload, priority=zenoh.Priority.REAL_TIME, express=True)

    def announce(self, key: str) -> Any:
        """Show on `key` that this client is alive, until it leaves or dies."""
        return self._session.liveliness().declare_token(key)

    def ask(self, key: str, payload: bytes = b"", *, timeout: float = 30.0) -> bytes:
        """Query `key` and return the answer; raises ClientError with the station's reason."""
        for reply in self._session.get(key, payload=payload, timeout=timeout):
            if reply.ok is not None:
                return bytes(reply.ok.payload.to_bytes())
            if reply.err is not None:
                raise ClientError(_reason(reply.err.payload.to_bytes()))
        raise ClientError(
            f"the station did not answer {key} within {timeout:g} s; if it runs, does its setting bus.prefix stand at "
            "the head of that key? It is named with --prefix"
        )


def given_login(file: str, role: Role) -> Login | None:
    """Return the login in a file that `teachpath login create` wrote; None where no file is named.

    Raises:
        ClientError: there is none in it, or it cannot be read.
    """
    try:
        login = next(iter(read_logins(Path(file))), None) if file else None
    except ValueError as error:
        raise ClientError(str(error)) from None
    if file and login is None:
        raise ClientError(f"there is no login in {file}; make one with: teachpath login create NAME --role {role}")
    return login


def _open_without_login(endpoint: str, timeout: float) -> zenoh.Session | None:
    protocol, _, address = endpoint.partition("/")
    host, _, port = address.rpartition(":")
    try:
        if protocol == "tcp":
            socket.create_connection((host.strip("[]"), int(port)), timeout).close()  # nobody there is known at once
            return open_session(joining(endpoint, None, timeout=timeout))
    except (OSError, ValueError, zenoh.ZError):
        pass
    return None


def _unreachable(endpoint: str, role: Role, login: Login | None, error: Exception) -> str:
    known = (
        f"does it still know the login {login.user!r}?"
        if login
        else f"this user has no login there ({logins_path(endpoint)}); its operator makes one with: "
        f"teachpath login create NAME --role {role}"
    )
    return f"no station at {endpoint}: is `teachpath serve` running there, and {known} ({error})"


def _reason(payload: bytes) -> str:
    try:
        return str(json.loads(payload)["message"])
    except (ValueError, KeyError, TypeError):
        return payload.decode(errors="replace")
