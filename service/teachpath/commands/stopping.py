"""A stop by two ways: over the web service, and over the bus where that does not answer."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING, Final

from teachpath.commands.options import connected
from teachpath.commands.references import WHOLE_ID, find_execution
from teachpath.errors import NotStopped as NotConfirmed
from teachpath.errors import TeachpathError, Unreachable
from teachpath_client.errors import NotStopped, Refused
from teachpath_client.errors import Unreachable as NoStation
from teachpath_proto.control import CommandVerb

if TYPE_CHECKING:
    from teachpath import records
    from teachpath.io.bus import Bus
    from teachpath_client.models import ExecutorStatus

    Status = ExecutorStatus | records.ExecutorStatus

WEB_TIMEOUT: Final = 0.3  # [s] after which a service that has not answered is not waited for alone
SERVER_FAULT: Final = 500  # HTTP status from which the fault is the service's
CONNECT_TIMEOUT: Final = 2.0  # [s] to join its bus


def stop_arm(address: str, execution: str) -> Status:
    """Stop the arm of the service at `address`, and return the executor's own status that shows it.

    A service of this user on this machine that does not answer at once is passed by: the stop goes over its bus, too.

    Args:
        address: of the service.
        execution: id of an execution or its beginning; empty: whatever moves.

    Raises:
        NotStopped: no status shows it, by neither way.
        TeachpathError: there is no such execution, or several.
        ClientError: the service refuses, as it does for an execution that it does not know.
    """
    answers: queue.SimpleQueue[Status | Exception] = queue.SimpleQueue()
    failures, pending = list[str](), 0
    for way, timeout in ((_over_web, WEB_TIMEOUT), (_over_bus, None)):
        _start(partial(way, address, execution), answers)
        pending += 1
        with suppress(queue.Empty):
            while pending:
                answer = answers.get(timeout=timeout)
                pending -= 1
                if not isinstance(answer, Exception):
                    return answer
                if not _may_stop_otherwise(answer):
                    raise answer
                failures.append(str(answer))
    raise NotStopped("; ".join(failures))


def _start(way: Callable[[], Status], answers: queue.SimpleQueue[Status | Exception]) -> None:
    """Go a way on a thread that keeps nobody from leaving; puts what comes of it into `answers`."""

    def go() -> None:
        try:
            answers.put(way())
        except Exception as error:  # raised where it is waited for
            answers.put(error)

    threading.Thread(target=go, name="stop", daemon=True).start()


def _may_stop_otherwise(error: Exception) -> bool:
    """Tell whether the service failed, and not who asks for the stop."""
    return isinstance(error, NotStopped | NoStation) or (isinstance(error, Refused) and error.status >= SERVER_FAULT)


def _over_web(address: str, execution: str) -> Status:
    with connected(address) as station:
        return station.stop(find_execution(station, execution)).status if execution else station.stop_arm()


def _over_bus(address: str, execution: str) -> Status:
    """Stop over the bus; without the service an id that is not whole stands for whatever moves."""
    from teachpath.io import wire
    from teachpath.io.running_services import running_services
    from teachpath.records import Command
    from teachpath.robot.stopper import Stopper
    from teachpath_proto.keys import Keys

    service = next((each for each in running_services() if each.url == address.rstrip("/") and each.endpoint), None)
    if service is None:
        raise NotStopped(f"NOT STOPPED: {address} is no service of yours on this machine, so its bus is not known")
    whole, keys = execution if WHOLE_ID.fullmatch(execution) else "", Keys(service.prefix)
    try:
        bus = _joined(service.endpoint)
        stopper = Stopper(bus, keys)
        try:
            bus.subscribe(keys.executor_status, lambda _, payload: stopper.on_status(wire.decode_status(payload)))
            return stopper.stop(Command(CommandVerb.STOP, whole, who="teachpath stop"), lambda: False)
        finally:
            stopper.close()
            bus.close()
    except NotConfirmed:
        raise NotStopped("NOT STOPPED: nor does the executor confirm the stop over the bus") from None
    except TeachpathError as error:
        raise NotStopped(f"NOT STOPPED: nor does the bus take it: {error}") from None


def _joined(endpoint: str) -> Bus:
    """Join a bus as an operator; logins outlast their station, and one that asks for none refuses whoever shows one."""
    from teachpath.io.bus import open_bus
    from teachpath.io.bus_settings import BusSettings
    from teachpath_proto.logins import Role, find_login

    settings, login = (
        BusSettings(endpoint=endpoint, connect_timeout=CONNECT_TIMEOUT),
        find_login(endpoint, Role.OPERATOR),
    )
    try:
        return open_bus(settings, login)
    except Unreachable as unreachable:
        if login is None:
            raise
        try:
            return open_bus(settings)
        except TeachpathError:
            raise unreachable from None
