"""serve, and the two processes that it starts: executor and simulator."""

from __future__ import annotations

import logging
import os
import sys
import threading
import time
from pathlib import Path
from typing import Annotated, Any

import typer

from teachpath.commands.options import Config, Data, settings_of
from teachpath.commands.serving import serving, until_signalled
from teachpath.config import Instructions, from_instructions, load
from teachpath.errors import UnusableSettings
from teachpath.io.bus import open_bus
from teachpath.io.bus_logins import local_login
from teachpath.io.signing_key import read_signing_key
from teachpath.logs import LogSettings, log_to_stderr
from teachpath.realtime import SIMULATOR_PRIORITY, request_realtime
from teachpath.robot.processes import STOP_TIMEOUT
from teachpath_proto.keys import Keys
from teachpath_proto.logins import Role

log = logging.getLogger("teachpath")

PARTS = {Role.EXECUTOR: "executor", Role.ROBOT: "simulator"}  # names of the processes in the log

Attached = Annotated[bool, typer.Option("--attached", hidden=True)]


def serve(
    config: Config = None,
    data: Data = None,
    port: Annotated[int | None, typer.Option(help="Web port; 8765 unless set.")] = None,
    log_format: Annotated[
        str, typer.Option(help="Of the lines of the log: text or json; as the settings say, unless set.")
    ] = "",
) -> None:
    """Run the service until Ctrl-C.

    It records what trackers show, works on jobs, moves the simulated arm, and serves the page and the REST API.
    """
    changes: dict[str, Any] = {} if port is None else {"web": {"port": port}}
    if log_format:
        changes["log"] = {"format": log_format}
    settings = settings_of(config, data, **changes)
    _log(settings.log)
    with until_signalled() as stop, serving(settings):
        print(f"teachpath serves http://{settings.web.host}:{settings.web.port} (API docs at /docs)", flush=True)
        print(f"trackers publish to {settings.bus.endpoint}; Ctrl-C ends it", flush=True)
        stop.wait()


def executor(config: Config = None, attached: Attached = False) -> None:
    """Run the executor alone.

    It streams the setpoints of certified plans.
    """
    from teachpath.executor.loop import Executor
    from teachpath.motion.planning.signature import SigningKey

    given = _instructions(config, attached, Role.EXECUTOR)
    settings = given.settings
    key = SigningKey(given.signing_key or read_signing_key(settings.bus.endpoint))
    with until_signalled() as stop:
        _leave_with_parent(stop, attached)
        bus = open_bus(settings.bus, given.login)
        try:
            Executor(
                bus,
                Keys(settings.bus.prefix),
                settings.executor,
                signing_key=key,
                robot=settings.bus.robot,
                motion=settings.motion,
                arm=settings.arm,
            ).run(stop)
        finally:
            bus.close()


def simulator(config: Config = None, attached: Attached = False) -> None:
    """Run the simulated Puma 560 alone.

    It follows the setpoints and publishes its joint state, as the driver of a real arm would.
    """
    from teachpath.simulator.loop import Simulator

    given = _instructions(config, attached, Role.ROBOT)
    settings = given.settings
    with until_signalled() as stop:
        _leave_with_parent(stop, attached)
        bus = open_bus(settings.bus, given.login)
        if settings.simulator.realtime:
            log.info("%s", request_realtime(SIMULATOR_PRIORITY))
        try:
            Simulator(
                bus,
                Keys(settings.bus.prefix),
                settings.scenes[0],
                settings.simulator,
                robot=settings.bus.robot,
                home=settings.motion.home,
                arm=settings.arm,
            ).run(stop)
        finally:
            bus.close()


def _instructions(config: Path | None, attached: bool, role: Role) -> Instructions:
    log_to_stderr(part=PARTS[role], attached=attached)
    if attached:
        return from_instructions(sys.stdin.readline())
    settings = load(config)
    return Instructions(settings, local_login(settings.bus, role))


def _leave_with_parent(stop: threading.Event, attached: bool) -> None:
    """Stop when the service that started this process is gone, even if it was killed."""
    if not attached:
        return

    def wait() -> None:
        # The parent never writes again: reading returns when its end of the pipe is closed.
        while os.read(sys.stdin.fileno(), 4096):
            continue
        stop.set()
        # Joining the bus cannot be interrupted, and waits long for a service that is gone.
        time.sleep(STOP_TIMEOUT)
        os._exit(1)

    threading.Thread(target=wait, name="parent", daemon=True).start()


def _log(settings: LogSettings) -> None:
    try:
        log_to_stderr(settings)
    except OSError as error:
        raise UnusableSettings(f"cannot write the log to {settings.file} (log.file): {error.strerror}") from None
