"""https on a real socket, by an authority of the station's own; http on the same port; a certificate that ends."""

import socket
import ssl
import threading
from collections.abc import Iterator
from contextlib import ExitStack, closing, contextmanager, suppress
from datetime import UTC, datetime, timedelta
from pathlib import Path

import httpx
import pytest
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import PlainTextResponse
from starlette.routing import Route, WebSocketRoute
from starlette.websockets import WebSocket
from websockets.sync.client import connect

from teachpath.api.https_only import HttpsOnly
from teachpath.commands.serving import listen
from teachpath.errors import UnusableSettings
from teachpath.io.web_certificates import issue_web_certificate, prepare_web_authority, web_expiry, web_hosts
from teachpath.web.certificate import WebCertificate, find_certificate
from teachpath.web.server import web_server
from teachpath.web.settings import WebSettings
from tests.ports import free_port
from tests.waiting import HANG, wait_until

CURRENT_TIME = datetime.now(UTC)
HOSTS = ["localhost", "127.0.0.1"]
LONG_TIMEOUT = 3600.0


def certified(folder: Path, *, now: datetime = CURRENT_TIME) -> Path:
    prepare_web_authority(folder, HOSTS, now)
    issue_web_certificate(folder, HOSTS, now)
    return folder


async def scheme(request: Request) -> PlainTextResponse:
    return PlainTextResponse(f"{request.url.scheme} {len(await request.body())}")


async def echo(page: WebSocket) -> None:
    await page.accept()
    await page.send_text(await page.receive_text())
    await page.close()


@contextmanager
def served(folder: Path, **settings: float) -> Iterator[int]:
    """Serve an application by https; yields the port."""
    places = ["/", "/authority", "/api/v1/stop", "/api/v1/executions/x/stop", "/api/v1/tasks/x/recording/stop"]
    routes = [Route(place, scheme, methods=["GET", "POST"]) for place in places]
    app = HttpsOnly(Starlette(routes=[*routes, WebSocketRoute("/echo", echo)]))
    port, chosen = free_port(), WebSettings(**settings)  # type: ignore[arg-type]
    server = web_server(app, chosen, WebCertificate(folder).context)
    with closing(listen("127.0.0.1", port)) as listener:
        thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]}, daemon=True)
        thread.start()
        wait_until(lambda: server.started, "the server has started")
        yield port
        server.should_exit = True
        thread.join(HANG)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return certified(tmp_path_factory.mktemp("tls"))


@pytest.fixture(scope="module")
def port(folder: Path) -> Iterator[int]:
    with served(folder, max_connections=10, request_timeout=LONG_TIMEOUT) as port:
        yield port


def client(folder: Path) -> httpx.Client:
    context = ssl.create_default_context(cafile=str(folder / "authority.pem"))
    context.verify_flags |= ssl.VERIFY_X509_STRICT
    return httpx.Client(verify=context, timeout=HANG, trust_env=False)


def shake_hands(*sides: ssl.SSLObject) -> None:
    for side in 4 * sides:
        with suppress(ssl.SSLWantReadError):
            side.do_handshake()


def rest(connection: socket.socket) -> bytes:
    pieces = []
    with suppress(ConnectionResetError):
        while piece := connection.recv(65536):
            pieces.append(piece)
    return b"".join(pieces)


@pytest.mark.parametrize("host", HOSTS)
def test_whoever_trusts_the_authority_speaks_https(folder: Path, port: int, host: str) -> None:
    with client(folder) as speaking:
        assert speaking.get(f"https://{host}:{port}/").text == "https 0"
        large = b"x" * 3_000_000
        assert speaking.post(f"https://{host}:{port}/", content=large).text == f"https {len(large)}"


def test_so_do_websockets(folder: Path, port: int) -> None:
    context = ssl.create_default_context(cafile=str(folder / "authority.pem"))
    with connect(f"wss://127.0.0.1:{port}/echo", ssl=context, proxy=None, open_timeout=HANG) as page:
        page.send("over TLS")
        assert page.recv(HANG) == "over TLS"


def test_nothing_comes_after_the_handshake_but_answers(folder: Path, port: int) -> None:
    """A session ticket would: whoever reads and writes on two threads trips over it."""
    context = ssl.create_default_context(cafile=str(folder / "authority.pem"))
    with context.wrap_socket(socket.create_connection(("127.0.0.1", port)), server_hostname="127.0.0.1") as page:
        page.sendall(b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n")
        assert b"https 0" in rest(page)
        assert page.version() == "TLSv1.3"
        assert page.session is None or not page.session.has_ticket


def test_whoever_does_not_trust_it_does_not(port: int) -> None:
    with pytest.raises(httpx.ConnectError, match="CERTIFICATE_VERIFY_FAILED"):
        httpx.get(f"https://127.0.0.1:{port}/", timeout=HANG, trust_env=False)


def test_http_on_the_same_port_is_sent_to_https_but_for_a_stop_and_the_authority(port: int) -> None:
    with httpx.Client(base_url=f"http://127.0.0.1:{port}", timeout=HANG, trust_env=False) as plain:
        answer = plain.get("/?task=a")
        assert answer.status_code == 307
        assert answer.headers["location"] == f"https://127.0.0.1:{port}/?task=a"
        assert plain.get("/authority").text == "http 0"
        assert plain.post("/api/v1/stop").text == plain.post("/api/v1/executions/x/stop").text == "http 0"
        for method, place in [("GET", "/api/v1/tasks"), ("POST", "/api/v1/tasks/x/recording/stop"), ("POST", "/")]:
            refused = plain.request(method, place)
            assert refused.status_code == 403
            assert f"https alone: https://127.0.0.1:{port}" in refused.json()["detail"]


def test_what_is_neither_is_told(port: int) -> None:
    with socket.create_connection(("127.0.0.1", port), timeout=HANG) as connection:
        connection.sendall(b"\x00\x01\x02\r\n\r\n")
        assert rest(connection).startswith(b"HTTP/1.1 400")
    with socket.create_connection(("127.0.0.1", port), timeout=HANG) as connection:
        connection.sendall(b"\x16 no handshake of TLS at all")
        assert rest(connection)[:1] in (b"", b"\x15")  # the end, perhaps after an alert


def test_old_protocols_are_refused(folder: Path, port: int) -> None:
    context = ssl.create_default_context(cafile=str(folder / "authority.pem"))
    context.set_ciphers("DEFAULT:@SECLEVEL=0")
    with pytest.warns(DeprecationWarning, match="TLSv1_1"):
        context.minimum_version = context.maximum_version = ssl.TLSVersion.TLSv1_1
    with socket.create_connection(("127.0.0.1", port), timeout=HANG) as connection, pytest.raises(ssl.SSLError):
        context.wrap_socket(connection, server_hostname="localhost")


@pytest.mark.parametrize("begun", [b"", b"\x16\x03\x01\x02\x00\x01"])
def test_for_a_new_connection_the_oldest_is_closed_that_has_not_finished_its_handshake(
    folder: Path, port: int, begun: bytes
) -> None:
    with ExitStack() as stack:
        hanging = [stack.enter_context(socket.create_connection(("127.0.0.1", port), timeout=HANG)) for _ in range(10)]
        for connection in hanging:
            connection.sendall(begun)
        with client(folder) as speaking:
            assert speaking.get(f"https://127.0.0.1:{port}/").text == "https 0"
        assert rest(hanging[0]) == b""


@pytest.mark.parametrize("begun", [b"", b"\x16\x03\x01\x02\x00\x01"])
def test_a_handshake_that_does_not_come_is_closed(folder: Path, begun: bytes) -> None:
    with (
        served(folder, request_timeout=0.3) as port,
        socket.create_connection(("127.0.0.1", port), timeout=HANG) as connection,
    ):
        connection.sendall(begun)
        assert rest(connection) == b""


# the files


def test_keys_are_for_their_owner_alone(folder: Path) -> None:
    assert {file.stat().st_mode & 0o777 for file in folder.iterdir()} == {0o600}
    assert sorted(file.name for file in folder.iterdir()) == [
        "authority.key", "authority.pem", "station.key", "station.pem",
    ]  # fmt: skip


def test_the_authority_stays_when_the_certificate_is_renewed_and_is_made_anew_for_a_name_it_may_not_vouch_for(
    tmp_path: Path,
) -> None:
    folder = certified(tmp_path / "tls")
    before = (folder / "authority.pem").read_bytes()
    private = ["robot.local", "192.168.7.7", "fd00::7", "localhost"]
    assert not prepare_web_authority(folder, private, CURRENT_TIME)
    issue_web_certificate(folder, private, CURRENT_TIME + timedelta(days=1))
    assert (folder / "authority.pem").read_bytes() == before
    assert web_hosts(folder) == private
    assert web_expiry(folder) == (CURRENT_TIME + timedelta(days=398)).replace(microsecond=0)
    for further in ("robot.lab.example", "203.0.113.7"):
        assert prepare_web_authority(folder, [*private, further], CURRENT_TIME)
        assert not prepare_web_authority(folder, [further], CURRENT_TIME)


def test_what_the_authority_may_not_vouch_for_is_not_believed(tmp_path: Path) -> None:
    """Whoever steals its key cannot pass for another site."""
    folder = tmp_path / "tls"
    prepare_web_authority(folder, HOSTS, CURRENT_TIME)
    issue_web_certificate(folder, ["elsewhere.example"], CURRENT_TIME)
    trusting = ssl.create_default_context(cafile=str(folder / "authority.pem"))
    there, here = ssl.MemoryBIO(), ssl.MemoryBIO()
    server = WebCertificate(folder).context.wrap_bio(there, here, server_side=True)
    asking = trusting.wrap_bio(here, there, server_hostname="elsewhere.example")
    with pytest.raises(ssl.SSLCertVerificationError, match="permitted subtree violation"):
        shake_hands(asking, server)


def test_the_end_is_told_before_it_comes_and_a_renewed_certificate_is_taken_up(tmp_path: Path) -> None:
    folder = certified(tmp_path / "tls")
    certificate, end = WebCertificate(folder), web_expiry(folder)
    assert certificate.notes(end - timedelta(days=31)) == []
    assert (
        f"ends on {end:%Y-%m-%d}; renew it with: teachpath tls init" in certificate.notes(end - timedelta(days=29))[0]
    )
    assert "and browsers refuse it" in certificate.notes(end)[0]
    issue_web_certificate(folder, HOSTS, CURRENT_TIME + timedelta(days=100))
    assert certificate.notes(end) == []


def test_a_pair_that_does_not_fit_spoils_nothing(tmp_path: Path) -> None:
    folder, other = certified(tmp_path / "tls"), certified(tmp_path / "other")
    certificate, key = WebCertificate(folder), (folder / "station.key").read_text()
    (folder / "station.key").write_bytes((other / "station.key").read_bytes())
    assert "the former certificate of the web port is still used" in certificate.notes(CURRENT_TIME)[0]
    (folder / "station.key").write_text(key)
    assert certificate.notes(CURRENT_TIME) == []
    (folder / "station.pem").unlink()
    assert "cannot read the certificate" in certificate.notes(CURRENT_TIME)[0]


def test_files_that_cannot_be_used_are_refused_with_the_way_out(tmp_path: Path) -> None:
    assert find_certificate(WebSettings(), str(tmp_path)) is None
    with pytest.raises(UnusableSettings, match="make it with teachpath tls init, or leave web"):
        find_certificate(WebSettings(tls=str(tmp_path / "none")), str(tmp_path))
    folder = certified(tmp_path / "tls")
    assert find_certificate(WebSettings(), str(tmp_path)) is not None
    (folder / "station.key").chmod(0o640)
    with pytest.raises(UnusableSettings, match="others may read or write the private key"):
        find_certificate(WebSettings(), str(tmp_path))
    (folder / "station.key").write_text("no key")
    (folder / "station.key").chmod(0o600)
    with pytest.raises(UnusableSettings, match="are no certificate with its private key"):
        find_certificate(WebSettings(), str(tmp_path))
