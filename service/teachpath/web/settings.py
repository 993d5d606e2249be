"""Settings of the web port."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from annotated_types import Ge, Gt, Le


@dataclass(frozen=True)
class WebSettings:
    """Where the REST API and the page are served."""

    # address to listen on; another than loopback only where auth.mode asks who somebody is
    host: str = "127.0.0.1"
    # TCP port of the REST API, the page and its WebSocket
    port: Annotated[int, Ge(1), Le(65535)] = 8765
    # what people call this station, e.g. "Cell 3, south": on its page, and in `teachpath status`
    display_name: str = ""
    # further names under which this station is reached, e.g. over the network or behind a proxy; none with a *
    hosts: tuple[str, ...] = ()
    # folder of station.pem and station.key, for https; empty: tls/ in the data folder, made by `teachpath tls init`
    tls: str = ""
    # addresses of proxies that are believed when they say for whom they ask (X-Forwarded-For, X-Forwarded-Proto)
    proxies: tuple[str, ...] = ()
    # bytes of the largest file that may be imported over REST
    largest_upload: Annotated[int, Ge(1024)] = 67108864
    # [s] that the head of a request may take, and its body before 1000 bytes for every further second have come
    request_timeout: Annotated[float, Gt(0), Le(3600)] = 10.0
    # connections that may be open at a time; for a new one the oldest that has sent no whole request is closed
    max_connections: Annotated[int, Ge(10), Le(100_000)] = 2000
