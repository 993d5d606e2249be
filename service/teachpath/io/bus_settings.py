"""Where the bus is, and how those who join it say who they are."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from annotated_types import Ge, Le


@dataclass(frozen=True)
class BusSettings:
    """Where the Zenoh session of this process meets the others.

    Attributes:
        endpoint: the service or its router listens here, workers and clients connect here; across machines
            tls/HOST:PORT.
        mode: peer: the service listens; router: it listens and passes on between further routers, too; client: a
            router listens at the tls/ endpoint instead, configured by `teachpath station router`.
        config: file of Zenoh's own configuration (JSON5) for the service's session, for what the station does not set
            itself; empty: none.
        prefix: first segments of every key; one per station.
        robot: name of the arm in its keys.
        access_control: every role has its own login and its own keys; false lets every program that reaches the
            endpoint do everything.
        certificates: folder of the certificates for a tls/ endpoint, which `teachpath station certificates` makes.
        connect_timeout: [s] how long to wait for the endpoint when connecting.
    """

    endpoint: str = "tcp/127.0.0.1:7447"
    mode: Literal["peer", "client", "router"] = "peer"
    config: str = ""
    prefix: str = "teachpath/station"
    robot: str = "puma560"
    access_control: bool = True
    certificates: str = "teachpath-certificates"
    connect_timeout: Annotated[float, Ge(0.1), Le(60)] = 10.0
