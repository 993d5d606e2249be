"""The bus: publish, subscribe, ask and liveliness, over Zenoh or within one process.

Receivers run on the transport's thread: they only append to a queue of their owner (zenoh-python forbids blocking or
calling its API inside a callback). Answers to queries run on a thread of their own, one per served key.
"""

from __future__ import annotations

import json
import queue
import re
import threading
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, nullcontext
from typing import Any, Protocol

import zenoh
import zenoh.ext

from teachpath.errors import TeachpathError, Unanswered, Unreachable, UnusableSettings
from teachpath.io.bus_access import CACHE_KEYS, BusAccess, listening_config
from teachpath.io.bus_config import read_bus_config
from teachpath.io.bus_delivery import WAITS, Delivery
from teachpath.io.bus_errors import pack_error, raise_again
from teachpath.io.bus_settings import BusSettings
from teachpath.io.declaration import Declaration
from teachpath_proto.logins import Login
from teachpath_proto.sessions import joining, listening, open_session

SESSION_ID = re.compile(rb"[0-9a-f]{1,32}")
TIMED_OUT = b"Timeout"  # what Zenoh says when those who serve a key have not answered in time
SENDING: dict[Delivery, dict[str, Any]] = {  # each priority has a queue of its own
    WAITS: {"congestion_control": zenoh.CongestionControl.BLOCK},
    Delivery.DROPS: {"congestion_control": zenoh.CongestionControl.DROP, "priority": zenoh.Priority.REAL_TIME},
    Delivery.DROPS_LAST: {"congestion_control": zenoh.CongestionControl.DROP, "priority": zenoh.Priority.DATA_HIGH},
}

Receive = Callable[[str, bytes], None]
ReceiveWithSource = Callable[[str, bytes, str], None]
Answer = Callable[[bytes], bytes]
Changed = Callable[[str, bool], None]
Missed = Callable[[int], None]


class Handle(Protocol):
    """Something declared on the bus; `close` takes it back."""

    def close(self) -> None:
        """Take the declaration back; a second call does nothing."""


class Bus(Protocol):
    """What every kind of bus can do."""

    def publish(self, key: str, payload: bytes, *, source: str | None = None, delivery: Delivery = WAITS) -> None:
        """Send `payload` to all subscribers of `key`; `source` is who sends behind this session, None: itself."""

    def subscribe(self, key: str, receive: Receive) -> Handle:
        """Call `receive(key, payload)` for all that is published on keys matching `key` (`*` one segment, `**` any)."""

    def subscribe_with_source(self, key: str, receive: ReceiveWithSource, *, missed: Missed | None = None) -> Handle:
        """Call `receive(key, payload, source)` likewise; `source` names the session that published.

        With `missed`, samples of publishers that keep a cache are asked for again when one is missing, and those that
        could not be had are counted: `missed(count)`. Plain publishers are served as well, without that.

        The source is empty where a foreign program's plain publisher does not say, for Zenoh tells nothing of it; then
        two of them cannot be told apart. A session's name is a secret of those who hear it, as a password is: whoever
        knows it can claim to be that session.
        """

    def history(self, key: str) -> list[bytes]:
        """Return the newest payloads on `key`, the oldest first, that its publishers with a cache still have."""

    def serve(self, key: str, answer: Answer) -> Handle:
        """Answer queries on `key`; a TeachpathError that `answer` raises is raised again where the query was asked."""

    def ask(self, key: str, payload: bytes = b"", *, timeout: float = 10.0) -> bytes:
        """Query `key` and return the answer.

        Raises:
            Unreachable: nobody serves the key.
            Unanswered: somebody does, and has not answered within `timeout` [s].
            TeachpathError: the one that the answering side raised.
        """

    def announce(self, key: str) -> Handle:
        """Show that a part is alive under `key` until the handle is closed or this process dies."""

    def watch(self, key: str, changed: Changed) -> Handle:
        """Call `changed(key, alive)` when a part under `key` comes or goes; parts already there come first."""

    def is_joined(self) -> bool:
        """Tell whether there is a line to any other session."""

    def close(self) -> None:
        """Take back every declaration and leave."""


def listen_on_bus(settings: BusSettings, access: BusAccess | None = None) -> Bus:
    """Open the station's bus as its one listening session, or where a router listens, as the service among its clients.

    Args:
        settings: where.
        access: the logins that are let in, each held to the keys of its role; None lets everybody do everything.

    Raises:
        Unreachable: the endpoint is taken, or there is no router.
        UnusableSettings: the file `bus.config` cannot be used.
    """
    below = read_bus_config(settings)
    for key, value in below.items():
        _require_known(settings.config, key, value)
    if settings.mode == "client":
        return _join(settings, access.own if access else None, below)
    guard: AbstractContextManager[dict[str, object]] = (
        nullcontext({}) if access is None else listening_config(access, settings.prefix)
    )
    with guard as guarded:
        return ZenohBus(
            {**below, **listening([settings.endpoint], settings.mode), **guarded},
            f"{settings.endpoint}: is it taken by another service?",
        )


def open_bus(settings: BusSettings, login: Login | None = None) -> Bus:
    """Join the station's bus as a client.

    Raises:
        Unreachable: nobody listens there, or the login is not let in.
    """
    return _join(settings, login, {})


def _join(settings: BusSettings, login: Login | None, below: Mapping[str, object]) -> Bus:
    return ZenohBus(
        {**below, **joining(settings.endpoint, login, timeout=settings.connect_timeout)},
        f"{settings.endpoint}: is the service running there, and is the login one of its own?",
    )


def _require_known(file: str, key: str, value: object) -> None:
    """Raise UnusableSettings where Zenoh does not take a value, with the innermost key to blame."""
    try:
        zenoh.Config().insert_json5(key, json.dumps(value))
    except zenoh.ZError as error:
        for name, inner in value.items() if isinstance(value, dict) else ():
            _require_known(file, f"{key}/{name}", inner)
        reason = re.search(r'"(.+?)"', str(error))  # the rest is about Zenoh's source
        raise UnusableSettings(
            f"Zenoh refuses {key} in {file} (bus.config): {reason[1] if reason else error}; its documents list the keys"
        ) from None


class ZenohBus:
    """A Zenoh session that meets nobody but the configured endpoint: no multicast, no gossip."""

    def __init__(self, values: Mapping[str, object], place: str) -> None:
        """Open a session with these values of Zenoh's configuration; `place` says where, for an error."""
        try:
            self._session = open_session(values)
        except zenoh.ZError as error:
            raise Unreachable(f"no Zenoh session at {place} ({error})") from error
        self._source = str(self._session.zid())
        self._lock = threading.Lock()
        self._publishers: dict[tuple[str, Delivery], Any] = {}
        self._handles: list[Handle] = []

    def publish(self, key: str, payload: bytes, *, source: str | None = None, delivery: Delivery = WAITS) -> None:
        """Send `payload` to all subscribers of `key`; see `Bus`."""
        with self._lock:
            publisher = self._publishers.get((key, delivery))
            if publisher is None:
                publisher = self._session.declare_publisher(key, **SENDING[delivery])
                self._publishers[key, delivery] = publisher
        publisher.put(payload, attachment=self._source if source is None else source)

    def subscribe(self, key: str, receive: Receive) -> Handle:
        """Call `receive(key, payload)` on Zenoh's thread for all that is published on keys matching `key`."""

        def callback(sample: zenoh.Sample) -> None:
            receive(str(sample.key_expr), sample.payload.to_bytes())

        return self._keep(Declaration(self._session.declare_subscriber(key, callback).undeclare))

    def subscribe_with_source(self, key: str, receive: ReceiveWithSource, *, missed: Missed | None = None) -> Handle:
        """Call `receive(key, payload, source)` on Zenoh's thread likewise; see `Bus`."""

        def callback(sample: zenoh.Sample) -> None:
            receive(str(sample.key_expr), sample.payload.to_bytes(), _source(sample))

        if missed is None:
            return self._keep(Declaration(self._session.declare_subscriber(key, callback).undeclare))
        recovery = zenoh.ext.RecoveryConfig(periodic_queries=None, heartbeat=True)
        subscriber = zenoh.ext.declare_advanced_subscriber(self._session, key, callback, recovery=recovery)
        listener = subscriber.sample_miss_listener(lambda miss: missed(miss.nb))

        def undeclare() -> None:
            listener.undeclare()  # type: ignore[no-untyped-call]
            subscriber.undeclare()  # type: ignore[no-untyped-call]

        return self._keep(Declaration(undeclare))

    def history(self, key: str) -> list[bytes]:
        """Return what publishers on `key` still have; see `Bus`. Whoever does not answer in 10 s is passed over."""
        replies = self._session.get(
            f"{key}/{CACHE_KEYS}",
            target=zenoh.QueryTarget.ALL,
            consolidation=zenoh.ConsolidationMode.NONE,
            accept_replies=zenoh.ReplyKeyExpr.ANY,
            timeout=10.0,
        )
        return [reply.ok.payload.to_bytes() for reply in replies if reply.ok is not None]

    def serve(self, key: str, answer: Answer) -> Handle:
        """Answer queries on `key` in the order they came, on a thread of its own; see `Bus`."""
        return self._keep(_Server(self._session, key, answer))

    def ask(self, key: str, payload: bytes = b"", *, timeout: float = 10.0) -> bytes:
        """Query `key` and return the first answer.

        Raises:
            Unreachable: nobody answered within `timeout` [s].
            TeachpathError: the one that the answering side raised.
        """
        for reply in self._session.get(key, payload=payload, timeout=timeout):
            if reply.ok is not None:
                return bytes(reply.ok.payload.to_bytes())
            if reply.err is not None:
                payload = reply.err.payload.to_bytes()
                if payload == TIMED_OUT:
                    raise Unanswered(f"{key} was not answered within {timeout:g} s; is that part of the service busy?")
                raise_again(payload, key)
        raise Unreachable(f"nobody answered {key} within {timeout:g} s; is that part of the service running?")

    def announce(self, key: str) -> Handle:
        """Declare a liveliness token on `key`; it goes with the handle, the session or the process."""
        return self._keep(Declaration(self._session.liveliness().declare_token(key).undeclare))

    def watch(self, key: str, changed: Changed) -> Handle:
        """Call `changed(key, alive)` on Zenoh's thread when a part comes or goes; those already there come first."""
        subscriber = self._session.liveliness().declare_subscriber(
            key, lambda s: changed(str(s.key_expr), s.kind == zenoh.SampleKind.PUT), history=True
        )
        return self._keep(Declaration(subscriber.undeclare))

    def is_joined(self) -> bool:
        """Tell whether there is a line to any other session; not to be called by a receiver."""
        return bool(self._session.info.routers_zid() or self._session.info.peers_zid())

    def close(self) -> None:
        """Take back every declaration, and close the session; a second call does nothing."""
        # A session that closes before an advanced subscriber is undeclared may keep the process from ending.
        for handle in self._handles:
            handle.close()
        self._handles.clear()
        if not self._session.is_closed():
            self._session.close()  # type: ignore[no-untyped-call]

    def _keep(self, handle: Handle) -> Handle:
        self._handles.append(handle)
        return handle


def _source(sample: zenoh.Sample) -> str:
    """Return the session that published: publishers that keep a cache say it by themselves, ours in an attachment."""
    if sample.source_info is not None:
        return str(sample.source_info.source_id.zid)
    attachment = b"" if sample.attachment is None else sample.attachment.to_bytes()
    return attachment.decode() if SESSION_ID.fullmatch(attachment) else ""


class _Server:
    """Answers the queries of one key in the order they came, on its own thread."""

    def __init__(self, session: Any, key: str, answer: Answer) -> None:
        self._key, self._answer = key, answer
        self._queries: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._queryable = session.declare_queryable(key, self._queries.put)
        self._thread: threading.Thread | None = threading.Thread(target=self._run, name=f"serve {key}", daemon=True)
        self._thread.start()

    def _run(self) -> None:
        while (query := self._queries.get()) is not None:
            with query:
                payload = query.payload.to_bytes() if query.payload is not None else b""
                try:
                    query.reply(self._key, self._answer(payload))
                except TeachpathError as error:
                    query.reply_err(pack_error(error))
                except Exception as error:
                    query.reply_err(pack_error(TeachpathError(f"{self._key} failed: {error!r}")))

    def close(self) -> None:
        """Answer no more; waits up to 5 s for the answer under way."""
        thread, self._thread = self._thread, None
        if thread is not None:
            self._queryable.undeclare()
            self._queries.put(None)
            thread.join(timeout=5.0)
