"""Another Unix user of the machine, who attacks a station; a process that gives up its rights before it does anything.

Reads from its standard input one line of JSON: what to read, where to join, and with which login. Prints what it could
read, whether it was let in without the login, and says "ready"; when its input ends, what it came to know.
"""

import json
import os
import sys
import time
from typing import Any

import zenoh
import zenoh.ext  # while it may still read the installation

from teachpath_proto.keys import Keys
from teachpath_proto.logins import Login, Role
from teachpath_proto.motion_pb2 import ExecutorCommand, LeaseRequest, Setpoint
from teachpath_proto.sessions import joining, open_session
from teachpath_proto.tracker_pb2 import HandSample

NOBODY_UID = 65534
KEYS = Keys()
OTHER_CONFIGURATION = [0.5, 1.0, -2.0, 0.0, -1.0, 0.5]  # [rad]


def readable(files: list[str]) -> list[str]:
    """Return the files that this user can read, or, of processes, open."""
    return [file for file in files if _opens(file)]


def _opens(file: str) -> bool:
    try:
        with open(file, "rb", buffering=0):
            return True
    except OSError:
        return False


def is_let_in(endpoint: str, login: Login | None) -> bool:
    """Tell whether a session opens."""
    try:
        open_session(joining(endpoint, login, timeout=1.0)).close()  # type: ignore[no-untyped-call]
    except zenoh.ZError:
        return False
    return True


def attack(session: Any) -> dict[str, list[str]]:
    """Try all five, and return lists in which stands what was swallowed, tapped and answered."""
    came: dict[str, list[str]] = {"swallowed": [], "tapped": [], "answered": []}
    plan = ExecutorCommand(verb=ExecutorCommand.VERB_START, execution="attack", plan=b"{}").SerializeToString()
    lease = LeaseRequest(action=LeaseRequest.ACTION_ACQUIRE, name="attack", seconds=30.0).SerializeToString()
    # Before anything is declared that would answer in this session.
    for key, payload in ((KEYS.executor_command, plan), (KEYS.executor_lease, lease), (KEYS.reset("puma560"), b"")):
        came["answered"] += [key for _ in session.get(key, payload=payload, timeout=1.0)]
    for key, name in ((KEYS.executor_stop, "swallowed"), (KEYS.executor_lease, "tapped")):
        session.declare_queryable(key, lambda query, name=name: came[name].append(str(query.key_expr)), complete=True)
    session.declare_subscriber(KEYS.executor_lease, lambda sample: came["tapped"].append(str(sample.key_expr)))
    for cycle in range(100):
        setpoint = Setpoint(cycle=cycle, nominal_ns=time.time_ns(), position=OTHER_CONFIGURATION, execution="attack")
        session.put(KEYS.setpoint("puma560"), setpoint.SerializeToString())
        session.put(KEYS.samples("hand"), HandSample(sequence=cycle, device_ns=time.time_ns()).SerializeToString())
    return came


def main() -> None:
    """Attack as another user."""
    given = json.loads(sys.stdin.readline())
    os.setgroups([])
    os.setgid(NOBODY_UID)
    os.setuid(NOBODY_UID)
    os.environ.clear()
    login = Login(**{**given["login"], "role": Role(given["login"]["role"])})
    guessed = Login("operator", "guessed", Role.OPERATOR)
    let_in = [who.user if who else "nobody" for who in (None, guessed) if is_let_in(given["endpoint"], who)]
    print(json.dumps({"read": readable(given["files"]), "let in": let_in}), flush=True)
    with open_session(joining(given["endpoint"], login, timeout=60.0)) as session:
        came = attack(session)
        print(json.dumps("ready"), flush=True)
        sys.stdin.read()
    print(json.dumps(came), flush=True)


if __name__ == "__main__":
    main()
