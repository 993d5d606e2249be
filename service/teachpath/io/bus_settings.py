"""Where the bus is, and how those who join it say who they are."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from annotated_types import Ge, Le


@dataclass(frozen=True)
class BusSettings:
    """Where the Zenoh session of this process meets the others."""

    # the service listens here as a Zenoh peer, workers and clients connect here; across machines tls/HOST:PORT
    endpoint: str = "tcp/127.0.0.1:7447"
    # first segments of every key; one per station
    prefix: str = "teachpath/station"
    # name of the arm in its keys
    robot: str = "puma560"
    # every role has its own login and its own keys; false lets every program that reaches the endpoint do everything
    access_control: bool = True
    # folder of the certificates for a tls/ endpoint, which `teachpath station certificates` makes
    certificates: str = "teachpath-certificates"
    # a Zenoh router listens at the tls/ endpoint instead of the service, configured by `teachpath station router`
    router: bool = False
    # [s] how long to wait for the endpoint when connecting
    connect_timeout: Annotated[float, Ge(0.1), Le(60)] = 10.0
