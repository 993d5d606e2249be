"""A station that asks for tokens, on a real port, and a token for every role."""

import asyncio
import time
from collections.abc import Iterator
from contextlib import contextmanager

from teachpath.access.tokens import new_token
from teachpath.app import Station
from teachpath.records import Capability
from teachpath_client.station import Station as Client
from tests.contract import stations
from tests.contract.desk import Desk
from tests.contract.rows import a_job, learned


class Guarded:
    """A station that asks for tokens; `tokens` has one for each role, whose name it bears."""

    def __init__(self, station: Station, loop: asyncio.Runner, port: int) -> None:
        self.station, self.desk, self.port = station, Desk(station, loop), port
        self.tokens = {role: self.make(role.value, role) for role in Capability}

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.port}"

    def make(self, name: str, *roles: Capability, days: float = 1.0) -> str:
        """Make a token, which holds at once."""
        token, kept = new_token(name, roles, now_ns=time.time_ns(), days=days)
        self.station.store.access_tokens.add(kept)
        self.station.access.refresh()
        return token

    def headers(self, role: Capability, **more: str) -> dict[str, str]:
        return {"Authorization": f"Bearer {self.tokens[role]}", **more}

    def client(self, role: Capability, operator: str = "") -> Client:
        return Client(self.url, token=self.tokens[role], operator=operator)

    def has_tracker(self, name: str) -> bool:
        return any(tracker.name == name and tracker.announced for tracker in self.station.recorder.trackers())

    def a_path(self) -> str:
        """Store a learned path and return its id."""
        store = self.station.store
        store.ensure_task("t", scene="paper", calibration="identity")
        store.add_job(a_job("learn-named"))
        return f"{store.finish_learning('learn-named', learned())}-1"


@contextmanager
def opened(**limits: float) -> Iterator[Guarded]:
    """Open a station that asks for tokens, with limits of one subject."""
    changes = {"auth": {"mode": "token"}, "web": {"hosts": ["robot.example"]}, "limits": limits}
    with stations.station(**changes) as station, asyncio.Runner() as loop, stations.web_port(station) as port:
        yield Guarded(station, loop, port)
