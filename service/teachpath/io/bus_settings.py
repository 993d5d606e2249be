"""Where the bus is, and how those who join it say who they are."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from annotated_types import Ge, Le


@dataclass(frozen=True)
class BusSettings:
    """Where the Zenoh session of this process meets the others.

    Attributes:
        endpoint: the service listens here as a Zenoh peer, workers and clients connect here; across machines
            tls/HOST:PORT.
        prefix: first segments of every key; one per station.
        robot: name of the arm in its keys.
        access_control: every role has its own login and its own keys; false lets every program that reaches the
            endpoint do everything.
        certificates: folder of the certificates for a tls/ endpoint, which `teachpath station certificates` makes.
        router: a Zenoh router listens at the tls/ endpoint instead of the service, configured by `teachpath station
            router`.
        connect_timeout: [s] how long to wait for the endpoint when connecting.
    """

    endpoint: str = "tcp/127.0.0.1:7447"
    prefix: str = "teachpath/station"
    robot: str = "puma560"
    access_control: bool = True
    certificates: str = "teachpath-certificates"
    router: bool = False
    connect_timeout: Annotated[float, Ge(0.1), Le(60)] = 10.0
