"""https from one command: page, programs and command line of a station that has made its own certificate."""

import hashlib
import ssl
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path

import httpx
import pytest
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import JSONResponse
from starlette.routing import Route
from typer.testing import CliRunner

from teachpath.__main__ import app
from teachpath.io.web_certificates import issue_web_certificate, prepare_web_authority
from teachpath.web.certificate import WebCertificate
from teachpath.web.settings import WebSettings
from teachpath_client.errors import NotStopped, Unreachable
from teachpath_client.station import Station as Client
from tests.contract import stations
from tests.contract.desk import Desk
from tests.waiting import HANG


@pytest.fixture(scope="module")
def state(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """The state folder of this user."""
    with pytest.MonkeyPatch.context() as environment:
        folder = tmp_path_factory.mktemp("state")
        environment.setenv("XDG_STATE_HOME", str(folder))
        yield folder


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory, state: Path) -> Path:
    folder = tmp_path_factory.mktemp("station") / "data"
    made = invoke("tls", "init", "--name", "robot.lab.example", "--address", "10.0.0.7", "--data", str(folder))
    assert "for localhost, 127.0.0.1, ::1, " in made
    assert "authority made: " in made
    assert "not there yet: " in made
    return folder


@pytest.fixture(scope="module")
def port(data: Path) -> Iterator[int]:
    web = {"hosts": ["robot.lab.example"]}
    with stations.station_in(data, web=web) as station, stations.web_port(station) as port:
        yield port


def invoke(*words: str) -> str:
    result = CliRunner().invoke(app, words)
    assert result.exception is None, result.exception
    return result.output


def test_programs_and_command_line_of_this_machine_trust_the_station(port: int) -> None:
    url = f"https://127.0.0.1:{port}"
    with Client(url) as client, client.events() as events:
        assert events.next(HANG) is not None
        assert client.health().version
    assert "empty" in invoke("scenes", "--url", url)


def test_elsewhere_they_are_told_what_to_trust(port: int, tmp_path: Path) -> None:
    with pytest.MonkeyPatch.context() as environment:
        environment.setenv("XDG_STATE_HOME", str(tmp_path))
        with Client(f"https://127.0.0.1:{port}") as client, pytest.raises(Unreachable) as found:
            client.health()
    assert "put the authority.pem of the station, which its page offers at /authority, into " in str(found.value)


def test_a_stop_is_sent_though_the_certificate_is_not_trusted(tmp_path: Path) -> None:
    """Its answer could be anybody's, so it confirms nothing; and no token is sent to whoever answers."""
    heard = list[Request]()

    async def stop(request: Request) -> JSONResponse:
        heard.append(request)
        return JSONResponse({"state": "idle"})

    hosts = ["127.0.0.1"]
    prepare_web_authority(tmp_path, hosts, datetime.now(UTC))
    issue_web_certificate(tmp_path, hosts, datetime.now(UTC))
    web = Starlette(routes=[Route("/api/v1/stop", stop, methods=["POST"])])
    with (
        stations.served(web, WebSettings(), WebCertificate(tmp_path).context) as port,
        Client(f"https://127.0.0.1:{port}", token="secret") as client,
        pytest.raises(NotStopped, match="not trusted"),
    ):
        client.stop_arm()
    (request,) = heard
    assert "authorization" not in request.headers


def test_a_device_is_given_the_authority_by_http_with_the_steps(port: int, data: Path) -> None:
    authority = (data / "tls" / "authority.pem").read_text()
    with httpx.Client(base_url=f"http://127.0.0.1:{port}", timeout=HANG, trust_env=False) as device:
        given = device.get("/authority.crt")
        assert given.text == authority
        assert given.headers["content-type"] == "application/x-x509-ca-cert"
        page = device.get("/authority")
        digest = hashlib.sha256(ssl.PEM_cert_to_DER_cert(authority)).hexdigest().upper()
        assert digest in page.text.replace(":", "")
        assert "http://robot.lab.example:" in page.text
        code = device.get("/authority/address.svg")
        assert code.headers["content-type"] == "image/svg+xml"
        assert code.text.startswith("<?xml")
        assert device.get("/api/v1/health/live").status_code == 200
        for answer in (given, page, code):
            assert "default-src 'none'" in answer.headers["content-security-policy"]


def test_renewing_keeps_the_authority_that_devices_trust(port: int, data: Path) -> None:
    authority = (data / "tls" / "authority.pem").read_text()
    said = invoke("tls", "init", "--data", str(data))
    assert "authority as before" in said
    assert "robot.lab.example, 10.0.0.7" in said
    assert (data / "tls" / "authority.pem").read_text() == authority


@pytest.mark.parametrize(
    ("words", "said"),
    [(("--name", "a b"), "'a b' is no host name"), (("--address", "here"), "--address here is no IP address")],
)
def test_what_is_no_host_is_refused(tmp_path: Path, words: tuple[str, ...], said: str) -> None:
    result = CliRunner().invoke(app, ["tls", "init", *words, "--data", str(tmp_path)])
    assert said in str(result.exception)
    assert not (tmp_path / "tls").exists()


def test_without_an_authority_of_its_own_a_station_offers_none(desk: Desk) -> None:
    for place in ("/authority", "/authority.crt", "/authority/address.svg"):
        answer = desk.send("GET", place)
        assert answer.status_code == 404
        assert "teachpath tls init makes one" in answer.json()["detail"]
