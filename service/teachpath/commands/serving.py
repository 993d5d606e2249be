"""A station with its web port open, in this process."""

from __future__ import annotations

import gc
import json
import os
import signal
import socket
import sys
import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from typing import TYPE_CHECKING, Final

from teachpath.commands.options import web_address
from teachpath.errors import Conflict, Unreachable

if TYPE_CHECKING:
    from teachpath.app import Station
    from teachpath.config import Settings

# [s] for which one thread keeps the interpreter while another waits for it; a stop passes through several threads
SWITCH_INTERVAL: Final = 0.0005
SIGNALS = frozenset({signal.SIGINT, signal.SIGTERM})
# What executor, simulated arm and processes of jobs have loaded when they begin; the last is what they take for theirs.
PROCESS_MODULES: Final = ("teachpath.config", "teachpath.executor.loop", "teachpath.simulator.loop")
PRELOADED: Final = (
    "teachpath.offline.learning_job",
    "teachpath.learning.relearn",
    "teachpath.motion.planning.plan",
    "teachpath.learning.adaptation.adapt",
    "teachpath.motion.planning.assessment",
    "teachpath.__main__",
)


@contextmanager
def serving(settings: Settings) -> Iterator[Station]:
    """Open a station and its web port; on leaving, everything it started has ended.

    Whatever this process and those that it starts write meanwhile is for its user alone.

    Raises:
        Unreachable: the web port or the Zenoh endpoint is taken.
        Conflict: another service uses the data folder.
        UnusableSettings: it would be open to whoever reaches it.
    """
    from teachpath.access.loopback import require_safe_binding
    from teachpath.access.proxy_people import FORWARDED_USER
    from teachpath.process_server import start_process_server

    web = settings.web
    require_safe_binding(settings.auth.mode, web.host, web.hosts, web.proxies)
    listener = listen(web.host, web.port)
    umask = os.umask(0o077)
    gc.disable()  # what a start loads stays: to look through it again and again takes a tenth of the start
    try:
        # Their matrices are small: threads of linear algebra would spend their time on waiting for each other.
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
        start_process_server((*PROCESS_MODULES, *PRELOADED))  # which loads them while this process loads what follows
        from teachpath.app import Station
        from teachpath.io.running_services import announced
        from teachpath.web.server import web_server

        with Station(settings) as station:
            context = station.certificate.context if station.certificate else None
            station.audit.note("the service", "", f"begins: {changed_settings(settings)}", "running")
            identity = (FORWARDED_USER, settings.proxy.groups_header)
            server = web_server(station.web, web, context, identity=identity)
            thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]}, name="web", daemon=True)
            thread.start()
            try:
                with short_pauses(), announced(web_address(settings), settings.bus.endpoint, settings.bus.prefix):
                    yield station
            finally:
                server.should_exit = True
                thread.join(timeout=2.0)
                listener.close()  # before the data folder is let go: who stands by for that listens here next
                station.audit.note("the service", "", "ends", "")
    finally:
        gc.enable()
        os.umask(umask)
        listener.close()


def stand_by(settings: Settings, stop: threading.Event, stack: ExitStack) -> Station | None:
    """Enter `serving` when the service that is the station's has ended; None: `stop` was set before.

    What a service needs is loaded by then.

    Raises:
        Unreachable: the web port or the Zenoh endpoint is another program's.
        UnusableSettings: see `serving`.
    """
    from teachpath.offline.standby import await_turn
    from teachpath.process_server import start_process_server

    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    start_process_server((*PROCESS_MODULES, *PRELOADED))
    import teachpath.app  # noqa: F401 - loads it

    def say(awaited: str) -> None:
        print(f"teachpath stands by: {awaited}", flush=True)

    while await_turn(settings.store, stop, say):
        with suppress(Conflict):  # another one that stood by was faster
            return stack.enter_context(serving(settings))
    return None


def changed_settings(settings: Settings) -> str:
    """Return the settings that are not at their defaults, as JSON; the database's may have a password in it."""
    from teachpath.config import Settings

    default = Settings().model_dump(mode="json")
    changed = {
        room: values
        if not isinstance(values, dict)
        else {name: value for name, value in values.items() if value != default[room][name] and name != "database"}
        for room, values in settings.model_dump(mode="json").items()
        if values != default[room]
    }
    return json.dumps(changed)


@contextmanager
def short_pauses() -> Iterator[None]:
    """Keep short what holds up every thread of this process: turns of the interpreter, and its garbage collector.

    The collector leaves out all that is there by now, libraries and the station itself: to look through it takes 0.2 s.
    """
    before = sys.getswitchinterval()
    sys.setswitchinterval(SWITCH_INTERVAL)
    gc.freeze()
    gc.enable()
    try:
        yield
    finally:
        gc.unfreeze()
        sys.setswitchinterval(before)


def listen(host: str, port: int) -> socket.socket:
    """Listen on a TCP port; raises Unreachable when that cannot be."""
    try:
        listener = socket.create_server((host, port), backlog=128)
    except OSError as error:
        raise Unreachable(
            f"cannot listen on {host}:{port} ({error.strerror}); is a service running there? Choose another: --port"
        ) from None
    # Connections inherit it. asyncio sets it only on sockets that it opened itself; without it an answer waits for the
    # client's delayed acknowledgement.
    listener.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return listener


def free_port() -> int:
    """Return a TCP port of loopback that nobody listens on now."""
    with socket.create_server(("127.0.0.1", 0)) as probe:
        port: int = probe.getsockname()[1]
        return port


@contextmanager
def until_signalled() -> Iterator[threading.Event]:
    """Set an event on Ctrl-C or SIGTERM instead of breaking off; the old handlers come back on leaving.

    The system may give a signal to any thread, one of Zenoh's too, and then the main thread sleeps on; and a handler
    must take no lock that it may have interrupted. So the signal's number goes through a socket to a thread that sets
    the event.
    """
    stop = threading.Event()
    hearing, telling = socket.socketpair()
    telling.setblocking(False)

    def listen() -> None:
        while numbers := hearing.recv(64):
            if not SIGNALS.isdisjoint(numbers):
                stop.set()

    handlers = {number: signal.signal(number, lambda *_: None) for number in SIGNALS}
    before = signal.set_wakeup_fd(telling.fileno(), warn_on_full_buffer=False)
    listener = threading.Thread(target=listen, name="signals", daemon=True)
    listener.start()
    try:
        yield stop
    finally:
        signal.set_wakeup_fd(before)
        for number, handler in handlers.items():
            signal.signal(number, handler)
        telling.close()
        listener.join()
        hearing.close()
