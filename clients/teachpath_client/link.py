"""The link to a station: a Zenoh client session that meets nobody but the named endpoint."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import zenoh
import zenoh.ext

CACHE_SIZE = 1024  # samples that a subscriber which missed some can still ask for
HEARTBEAT = 0.2  # [s] after a put until a subscriber is told its number, so that a lost last one is missed too


class ClientError(Exception):
    """The station cannot be reached, or refused; the text is a sentence for the operator."""


class Link:
    """A session with one station; use it as a context manager.

    Raises:
        ClientError: nobody listens at `endpoint`.
    """

    def __init__(self, endpoint: str, *, timeout: float = 10.0) -> None:
        config = zenoh.Config()
        for path, value in {
            "mode": "client",
            "connect/endpoints": [endpoint],
            "connect/timeout_ms": int(timeout * 1000),
            "connect/exit_on_failure": True,
            "scouting/multicast/enabled": False,
            "scouting/gossip/enabled": False,
        }.items():
            config.insert_json5(path, json.dumps(value))
        try:
            self._session = zenoh.open(config)
        except zenoh.ZError as error:
            raise ClientError(f"no station at {endpoint}: is `teachpath serve` running there? ({error})") from error
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
        """Return a publisher on `key` that blocks rather than drops, and sends again what a subscriber missed."""
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

    def announce(self, key: str) -> Any:
        """Show on `key` that this client is alive, until it leaves or dies."""
        return self._session.liveliness().declare_token(key)

    def ask(self, key: str, payload: bytes = b"", *, timeout: float = 10.0) -> bytes:
        """Query `key` and return the answer; raises ClientError with the station's reason."""
        for reply in self._session.get(key, payload=payload, timeout=timeout):
            if reply.ok is not None:
                return bytes(reply.ok.payload.to_bytes())
            if reply.err is not None:
                raise ClientError(_reason(reply.err.payload.to_bytes()))
        raise ClientError(f"the station did not answer {key} within {timeout:g} s")


def _reason(payload: bytes) -> str:
    try:
        return str(json.loads(payload)["message"])
    except (ValueError, KeyError, TypeError):
        return payload.decode(errors="replace")
