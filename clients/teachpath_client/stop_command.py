"""`teachpath-client stop`: the arm is stopped over the bus, whether or not the web service answers."""

from __future__ import annotations

import argparse
from typing import Final

from teachpath_client.bus_stop import is_resting, stop_over_bus
from teachpath_client.link import Link, given_login
from teachpath_proto.logins import Role

COMMAND_HELP: Final = (
    "Stop the arm on its path over the bus, whoever moves it and whether or not the station's web service answers. It "
    "says stopped when the executor's own status shows it, else NOT STOPPED with exit status 1. This is not an "
    "emergency stop."
)


def add_stop(stop: argparse.ArgumentParser) -> None:
    """Add the arguments of `teachpath-client stop`."""
    stop.add_argument("execution", nargs="?", default="", metavar="EXECUTION", help="its id; default: whatever moves")
    stop.set_defaults(run=_stop)


def _stop(options: argparse.Namespace) -> None:
    login = given_login(options.login, Role.OPERATOR)
    with Link(options.endpoint, role=Role.OPERATOR, login=login) as link:
        status = stop_over_bus(link, options.execution, prefix=options.prefix, who="teachpath-client stop")
    if not status.execution:
        print("stopped: nothing moves the arm")
        return
    ending = f"has {status.state}" if is_resting(status) else "comes to rest on its path"
    print(f"stopped: {status.execution} {ending}")
