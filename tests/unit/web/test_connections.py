"""Connections on real sockets: who sends a request slowly, or reads no answer, is closed, to make room for others."""

import asyncio
import json
import socket
import threading
import time
from collections.abc import AsyncIterator, Iterator
from contextlib import ExitStack, contextmanager, suppress
from typing import Any

import pytest
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import JSONResponse, PlainTextResponse, StreamingResponse
from starlette.routing import Route, WebSocketRoute
from starlette.websockets import WebSocket

from teachpath.api.middleware import AnswersAtTheEnd, RequestLimits
from teachpath.commands.serving import listen
from teachpath.web.server import web_server
from teachpath.web.settings import WebSettings
from teachpath_client.rest import IDLE_TIMEOUT, Rest
from tests.ports import free_port
from tests.waiting import HANG, wait_until

SHORT_TIMEOUT = 0.3  # [s] after which a client of these tests is too slow
LONG_TIMEOUT = 3600.0
REQUESTED = threading.Event()  # somebody waits for what never comes
FINISHED = threading.Event()  # nothing more is sent to a client of these tests
LARGE_BODY = 16 * 1024 * 1024  # bytes; more than all buffers on the way hold
HANDSHAKE = (
    b"GET /messages HTTP/1.1\r\nHost: x\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
    b"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n"
)


async def answer(request: Request) -> PlainTextResponse:
    return PlainTextResponse(f"{len(await request.body())} bytes")


async def wait_for_ever(request: Request) -> PlainTextResponse:
    REQUESTED.set()
    await asyncio.Event().wait()
    raise AssertionError


async def client(request: Request) -> PlainTextResponse:
    who, groups = (request.headers.get(f"x-forwarded-{name}", "nobody") for name in ("user", "groups"))
    return PlainTextResponse(f"{request.client and request.client.host} by {request.url.scheme} as {who} in {groups}")


async def port_of_client(request: Request) -> JSONResponse:
    return JSONResponse(request.client and request.client.port)


async def pour(request: Request) -> StreamingResponse:
    return StreamingResponse(pieces())


async def pieces() -> AsyncIterator[str]:
    """Give much, and then, when that was taken or the reader has gone, a little more."""
    try:
        yield "x" * LARGE_BODY
        yield "x"
    finally:
        FINISHED.set()


async def pour_messages(page: WebSocket) -> None:
    await page.accept()
    with suppress(Exception):  # the page has gone
        while True:
            await page.send_text("x" * 65536)
    FINISHED.set()


@contextmanager
def served(**settings: Any) -> Iterator[int]:
    """Serve an application with these settings; yields the port."""
    routes = [
        Route("/", answer, methods=["GET", "POST"]),
        Route("/client", client),
        Route("/api/v1/port", port_of_client),
        Route("/large", pour),
        Route("/never", wait_for_ever),
        WebSocketRoute("/messages", pour_messages),
    ]
    port, chosen = free_port(), WebSettings(**settings)
    server = web_server(AnswersAtTheEnd(RequestLimits(Starlette(routes=routes), settings=chosen)), chosen)
    with listen("127.0.0.1", port) as listener:
        thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]}, daemon=True)
        thread.start()
        wait_until(lambda: server.started, "the server has started")
        yield port
        server.should_exit = True
        thread.join(HANG)


def opened(port: int, sent: bytes = b"") -> socket.socket:
    connection = socket.create_connection(("127.0.0.1", port), timeout=HANG)
    connection.sendall(sent)
    return connection


def rest(connection: socket.socket) -> bytes:
    """Read until the server closes the connection."""
    pieces = []
    with suppress(ConnectionResetError):
        while piece := connection.recv(65536):
            pieces.append(piece)
    return b"".join(pieces)


def refusal(answered: bytes, status: int) -> str:
    head, _, body = answered.partition(b"\r\n\r\n")
    assert head.startswith(f"HTTP/1.1 {status} ".encode())
    sentence: str = json.loads(body)["detail"] if body.startswith(b"{") else body.decode()
    return sentence


def answered(port: int, sent: bytes = b"GET / HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n") -> bytes:
    """Ask until that is answered: this process may get no turn for so long that it is too slow a client."""

    def asked() -> bytes:
        with opened(port, sent) as connection:
            said = rest(connection)
        return said if said.startswith(b"HTTP/1.1 200") else b""

    return wait_until(asked, "it is answered")


@pytest.mark.parametrize(
    ("proxies", "told"),
    [
        (("10.0.0.1",), b"127.0.0.1 by http as nobody in nobody"),
        (("127.0.0.2", "10.0.0.0/8"), b"127.0.0.1 by http as nobody in nobody"),
        (("127.0.0.1",), b"192.0.2.7 by https as anna in lab"),
        ((), b"127.0.0.1 by http as anna in lab"),  # where nobody asks for the name
    ],
)
def test_only_a_proxy_that_is_named_is_believed_for_whom_it_asks(proxies: tuple[str, ...], told: bytes) -> None:
    said = b"X-Forwarded-For: 192.0.2.7\r\nX-Forwarded-Proto: https\r\n"
    said += b"X-Forwarded-User: anna\r\nX-Forwarded-Groups: lab\r\n"
    sent = b"GET /client HTTP/1.1\r\nHost: x\r\nConnection: close\r\n" + said + b"\r\n"
    with served(proxies=proxies) as port, opened(port, sent) as connection:
        assert rest(connection).endswith(told)


@pytest.mark.parametrize("sent", [b"", b"GET / HTTP/1.1\r\nHost: "])
def test_a_request_whose_head_does_not_come_is_closed(sent: bytes) -> None:
    with served(request_timeout=SHORT_TIMEOUT) as port, opened(port, sent) as connection:
        assert "web.request_timeout" in refusal(rest(connection), 408)
        assert answered(port).endswith(b"\r\n0 bytes")


def test_so_is_the_second_request_of_a_connection() -> None:
    with served(request_timeout=SHORT_TIMEOUT) as port, ExitStack() as stack:

        def opens() -> socket.socket | None:
            connection = stack.enter_context(opened(port, b"GET / HTTP/1.1\r\nHost: x\r\n\r\n"))
            return connection if connection.recv(65536).startswith(b"HTTP/1.1 200") else None

        connection = wait_until(opens, "the first one is answered")
        assert connection is not None
        connection.sendall(b"GET / HTTP/1.1\r\nHost: ")
        came = rest(connection)
        assert "web.request_timeout" in refusal(came[came.rindex(b"HTTP/1.1") :], 408)


def test_a_body_that_does_not_come_is_refused() -> None:
    head = b"POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 100\r\nConnection: close\r\n\r\n"
    with served(request_timeout=SHORT_TIMEOUT) as port:
        with opened(port, head + b"x" * 60) as connection:
            assert "60 bytes of the body came" in refusal(rest(connection), 408)
        assert answered(port, head + b"x" * 100).endswith(b"100 bytes")


def test_a_request_that_waits_when_the_service_ends_is_answered() -> None:
    with ExitStack() as stack:
        with served(request_timeout=LONG_TIMEOUT) as port:
            connection = stack.enter_context(opened(port, b"GET /never HTTP/1.1\r\nHost: x\r\n\r\n"))
            assert REQUESTED.wait(HANG)
        assert "the service ends" in refusal(rest(connection), 503)


def test_a_reader_that_takes_nothing_is_closed() -> None:
    FINISHED.clear()
    with (
        served(request_timeout=SHORT_TIMEOUT) as port,
        opened(port, b"GET /large HTTP/1.1\r\nHost: x\r\n\r\n") as connection,
    ):
        assert FINISHED.wait(HANG)
        assert len(rest(connection)) < LARGE_BODY


def test_a_page_that_reads_no_message_is_closed() -> None:
    FINISHED.clear()
    with served(request_timeout=SHORT_TIMEOUT) as port, opened(port, HANDSHAKE) as connection:
        assert FINISHED.wait(HANG)
        assert rest(connection).startswith(b"HTTP/1.1 101")  # and it ends


def test_for_a_new_connection_the_oldest_without_a_request_is_closed() -> None:
    with served(request_timeout=LONG_TIMEOUT, max_connections=10) as port, ExitStack() as stack:
        hanging = [stack.enter_context(opened(port, b"GET / HTTP/1.1\r\nHost: ")) for _ in range(10)]
        assert answered(port).endswith(b"\r\n0 bytes")
        assert rest(hanging[0]) == b""
        hanging[-1].sendall(b"x\r\nConnection: close\r\n\r\n")
        assert rest(hanging[-1]).endswith(b"0 bytes")


def test_when_all_connections_are_used_another_is_refused_with_a_sentence() -> None:
    with served(request_timeout=LONG_TIMEOUT, max_connections=10) as port, ExitStack() as stack:
        for _ in range(10):
            page = stack.enter_context(opened(port, HANDSHAKE))
            assert page.recv(12) == b"HTTP/1.1 101"
        with opened(port) as connection:
            assert "10 connections are open, the limit" in refusal(rest(connection), 503)


def test_the_client_uses_no_connection_again_that_the_service_may_just_close() -> None:
    assert web_server(answer, WebSettings()).config.timeout_keep_alive > 2 * IDLE_TIMEOUT
    with served() as port, Rest(f"http://127.0.0.1:{port}") as rest:
        first = rest.call("GET", "/port")
        time.sleep(IDLE_TIMEOUT + 0.1)
        assert rest.call("GET", "/port") != first
