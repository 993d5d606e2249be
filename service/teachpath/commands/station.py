"""serve, and the two processes that it starts: executor and simulator."""

from __future__ import annotations

import os
import sys
import threading
import time
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from teachpath.commands.options import Config, Data, motion_arm, settings_of, web_address, with_arm
from teachpath.errors import Conflict, UnusableSettings
from teachpath_proto.keys import Keys
from teachpath_proto.logins import Role

if TYPE_CHECKING:
    from teachpath.instructions import Instructions
    from teachpath.logs import LogSettings

PROCESS_NAMES = {Role.EXECUTOR: "executor", Role.ROBOT: "simulator"}  # names of the processes in the log

Attached = Annotated[bool, typer.Option("--attached", hidden=True)]


def serve(
    config: Config = None,
    data: Data = None,
    arm: Annotated[str, typer.Option(help="Arm of the station: one of teachpath arms, or of teachpath arm list.")] = "",
    port: Annotated[int | None, typer.Option(help="Web port; 8765 unless set.")] = None,
    log_format: Annotated[
        str, typer.Option(help="Of the lines of the log: text or json; as the settings say, unless set.")
    ] = "",
    standby: Annotated[
        bool, typer.Option("--standby", help="Where a service is the station's, wait for its end and take its place.")
    ] = False,
) -> None:
    """Run the service until Ctrl-C.

    It records what trackers show, works on jobs, moves the simulated arm, and serves the page and the REST API.
    The port of the bus is a setting: bus.endpoint, or TEACHPATH_BUS__ENDPOINT=tcp/127.0.0.1:PORT.
    """
    from teachpath.commands.serving import serving, stand_by, until_signalled

    changes: dict[str, Any] = ({} if port is None else {"web": {"port": port}}) | motion_arm(arm)
    if log_format:
        changes["log"] = {"format": log_format}
    settings = settings_of(config, data, **changes)
    _log(settings.log)
    with until_signalled() as stop, ExitStack() as stack:
        station = stand_by(settings, stop, stack) if standby else stack.enter_context(serving(settings))
        if station is None:
            return
        station.lease.when_taken(stop.set)
        print(f"teachpath serves {web_address(settings)} (API docs at /docs)", flush=True)
        print(f"trackers publish to {settings.bus.endpoint}; Ctrl-C ends it", flush=True)
        stop.wait()
    if station.lease.taken:
        raise Conflict(station.lease.taken)


def worker(config: Config = None, data: Data = None) -> None:
    """Do learning jobs for a station until Ctrl-C, on another machine or beside its service.

    It needs the station's settings, its database on PostgreSQL (store.database), and its recordings: in
    object storage (store.recordings), or in its data folder on a shared disk.
    """
    from teachpath.commands.serving import PRELOADED, until_signalled
    from teachpath.job_service import JobService
    from teachpath.process_server import start_process_server

    settings = settings_of(config, data)
    _log(settings.log)
    start_process_server(PRELOADED)
    with until_signalled() as stop, JobService(settings):
        print(f"teachpath works on the learning jobs of station {settings.store.station!r}; Ctrl-C ends it", flush=True)
        stop.wait()


def executor(config: Config = None, attached: Attached = False) -> None:
    """Run the executor alone.

    It streams the setpoints of certified plans.
    """
    from teachpath.commands.serving import until_signalled
    from teachpath.executor.loop import Executor
    from teachpath.io.bus import open_bus
    from teachpath.io.signing_key import read_signing_key
    from teachpath.motion.planning.signature import SigningKey
    from teachpath.realtime import realtime_threads

    given = _instructions(config, attached, Role.EXECUTOR)
    settings = given.settings
    key = SigningKey(given.signing_key or read_signing_key(settings.bus.endpoint))
    with until_signalled() as stop:
        _leave_with_parent(stop, attached)
        with realtime_threads(settings.executor.realtime):
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
    """Run the simulated arm alone.

    It follows the setpoints and publishes its joint state, as the driver of a real arm would.
    """
    from teachpath.commands.serving import until_signalled
    from teachpath.io.bus import open_bus
    from teachpath.realtime import realtime_threads
    from teachpath.simulator.loop import Simulator

    given = _instructions(config, attached, Role.ROBOT)
    settings = given.settings
    with until_signalled() as stop:
        _leave_with_parent(stop, attached)
        with realtime_threads(settings.simulator.realtime):
            bus = open_bus(settings.bus, given.login)
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
    from teachpath.config import load
    from teachpath.instructions import Instructions, from_instructions
    from teachpath.io.bus_logins import local_login
    from teachpath.logs import log_to_stderr

    log_to_stderr(part=PROCESS_NAMES[role], attached=attached)
    if attached:
        return from_instructions(sys.stdin.readline())
    settings = with_arm(load(config))
    return Instructions(settings, local_login(settings.bus, role))


def _leave_with_parent(stop: threading.Event, attached: bool) -> None:
    """Stop when the service that started this process is gone, even if it was killed."""
    if not attached:
        return
    from teachpath.robot.processes import STOP_TIMEOUT

    def wait() -> None:
        """Wait until the parent has ended, and end too."""
        # The parent never writes again: reading returns when its end of the pipe is closed.
        while os.read(sys.stdin.fileno(), 4096):
            continue
        stop.set()
        # Joining the bus cannot be interrupted, and waits long for a service that is gone.
        time.sleep(STOP_TIMEOUT)
        os._exit(1)

    threading.Thread(target=wait, name="parent", daemon=True).start()


def _log(settings: LogSettings) -> None:
    from teachpath.logs import log_to_stderr

    try:
        log_to_stderr(settings)
    except OSError as error:
        raise UnusableSettings(f"cannot write the log to {settings.file} (log.file): {error.strerror}") from None
