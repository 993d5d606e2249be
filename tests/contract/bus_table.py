"""What each role may do on the bus, as a table, and members that try it."""

import json
import queue
from typing import Any

import zenoh

from teachpath.errors import Unreachable
from teachpath.io.bus import Bus, BusSettings
from teachpath_proto.logins import Login, Role

PREFIX = "teachpath/station"


MEMBERS = (Role.EXECUTOR, Role.ROBOT, Role.TRACKER, Role.OPERATOR, Role.VIEWER)


# Who may put (p), hear (h), serve (s) and ask (a) on which key; nobody deletes.
TABLE = """
key                      executor  robot  tracker  operator  viewer
executor/command         s         -      -        a         -
executor/stop            hs        pa     pa       pa        pa
executor/lease           s         -      -        a         -
executor/status          p         h      -        h         h
executor/journal         p         -      -        h         h
robot/puma560/setpoint   p         h      -        h         h
robot/puma560/state      h         p      -        h         h
robot/puma560/reset      a         s      -        -         -
trackers/glove/samples   h         -      p        h         h
trackers/glove/feedback  -         -      h        h         h
recorder/start           -         -      a        a         -
recorder/stop            -         -      a        a         -
recorder/pause           -         -      a        a         -
recorder/resume          -         -      a        a         -
recorder/discard         -         -      a        a         -
recorder/restore         -         -      a        a         -
recorder/amend           -         -      a        a         -
recorder/status          -         -      a        a         a
jobs/job-1               -         -      -        h         h
station/certificate      a         -      -        -         -
station/scene            a         -      -        -         -
scenes/paper/object      -         -      p        p         -
elsewhere                -         -      -        -         -
"""


VERBS = {"p": "put", "h": "subscribe", "s": "serve", "a": "ask"}


ROWS = [line.split() for line in TABLE.strip().splitlines()]


KEYS = [f"{PREFIX}/{key}" for key, *_ in ROWS[1:]]


STOP = f"{PREFIX}/executor/stop"


DENIAL_WAIT = 1.0  # [s] until a question that nobody lets through is given up


def answered(bus: Bus, key: str) -> bool:
    try:
        return bus.ask(key, timeout=DENIAL_WAIT) == b"done"
    except Unreachable:
        return False


def drain(heard: queue.Queue[tuple[str, bytes]]) -> list[tuple[str, bytes]]:
    """Return what has come, after a moment for it to come."""
    try:
        came = [heard.get(timeout=0.05)]
    except queue.Empty:
        return []
    while not heard.empty():
        came.append(heard.get())
    return came


def asked(bus: Bus, key: str, timeout: float = DENIAL_WAIT) -> bool:
    try:
        return bool(bus.ask(key, timeout=timeout))
    except Unreachable:
        return False


def raw(settings: BusSettings, login: Login) -> Any:
    """Open a session that may try what our own bus never would."""
    config = zenoh.Config()
    for path, value in {
        "mode": "client",
        "connect/endpoints": [settings.endpoint],
        "scouting/multicast/enabled": False,
        "transport/auth/usrpwd": {"user": login.user, "password": login.password},
    }.items():
        config.insert_json5(path, json.dumps(value))
    return zenoh.open(config)
