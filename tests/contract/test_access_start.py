"""Who may use a station that asks nobody, and with which settings none starts."""

import asyncio
from typing import Any

import httpx
import pytest

from teachpath.access.loopback import require_safe_binding
from teachpath.commands.serving import serving
from teachpath.config import load
from teachpath.errors import UnusableSettings
from tests.contract.desk import Desk, refused


@pytest.mark.parametrize(
    ("client", "server", "headers", "sentence"),
    [
        ("192.168.7.9", "127.0.0.1", {}, "the client of this connection is 192.168.7.9"),
        ("::ffff:192.168.7.9", "127.0.0.1", {}, "the client of this connection"),
        ("127.0.0.1", "192.168.7.2", {}, "the server of this connection is 192.168.7.2"),
        ("127.0.0.1", "127.0.0.1", {"x-forwarded-for": "192.168.7.9"}, "a proxy has passed this on"),
        ("127.0.0.1", "127.0.0.1", {"forwarded": "for=192.168.7.9"}, "a proxy has passed this on"),
        ("127.0.0.1", "127.0.0.1", {"via": "1.1 lab"}, "a proxy has passed this on"),
        ("127.0.0.1", "127.0.0.1", {"origin": "https://evil.example"}, "a page of 'https://evil.example' asks"),
        ("127.0.0.1", "127.0.0.1", {"origin": "null"}, "a page of 'null' asks"),
        ("127.0.0.1", "127.0.0.1", {"origin": "http://localhost.evil.example"}, "a page of"),
        ("127.0.0.1", "127.0.0.1", {"origin": "http://127.0.0.1:1@evil.example"}, "a page of"),
    ],
)
def test_a_station_that_asks_nobody_answers_its_own_machine_alone(
    desk: Desk, client: str, server: str, headers: dict[str, str], sentence: str
) -> None:
    answer = asyncio.run(_ask(desk.station.web, (client, 51234), server, headers))
    refused(answer, 403, sentence)
    assert "auth.mode" in answer.json()["detail"]


@pytest.mark.parametrize("host", ["127.0.0.1", "127.0.0.53", "::1", "::ffff:127.0.0.1"])
def test_all_of_loopback_is_its_own_machine(desk: Desk, host: str) -> None:
    assert asyncio.run(_ask(desk.station.web, (host, 51234), "127.0.0.1", {})).status_code == 200


async def _ask(app: Any, client: tuple[str, int], server: str, headers: dict[str, str]) -> httpx.Response:
    async with httpx.AsyncClient(
        transport=httpx.ASGITransport(app, client=client), base_url=f"http://{server}:8765"
    ) as asking:
        return await asking.get("/api/v1/tasks", headers={"host": "127.0.0.1:8765"} | headers)


@pytest.mark.parametrize(
    ("mode", "host", "hosts", "sentence"),
    [
        ("proxy", "192.168.7.2", (), "let web.host be loopback"),
        ("proxy", "127.0.0.1", ("lab.example",), "name the proxy in web.proxies"),
        ("none", "0.0.0.0", (), "everybody who reaches it could move the arm"),
        ("none", "192.168.7.2", (), "web.host is '192.168.7.2'"),
        ("none", "::", (), "auth.mode is none"),
        ("none", "", (), "auth.mode is none"),
        ("none", "127.0.0.1", ("robot.example",), "web.hosts is 'robot.example'"),
        ("none", "127.0.0.1", ("*",), "DNS rebinding"),
        ("token", "192.168.7.2", ("*",), "DNS rebinding"),
        ("token", "127.0.0.1", ("*.example",), "name each host"),
        ("token", "0.0.0.0", (), "every request would be refused"),
    ],
)
def test_a_station_does_not_start_open(mode: str, host: str, hosts: tuple[str, ...], sentence: str) -> None:
    with pytest.raises(UnusableSettings) as found:
        require_safe_binding(mode, host, hosts)
    assert sentence in str(found.value)
    settings = load(document={"auth": {"mode": mode}, "web": {"host": host, "hosts": list(hosts)}})
    with pytest.raises(UnusableSettings), serving(settings):
        pass


def test_a_station_with_tokens_may_be_on_a_network() -> None:
    require_safe_binding("token", "192.168.7.2", ())
    require_safe_binding("token", "0.0.0.0", ("robot.example",))
    require_safe_binding("none", "localhost", ("127.0.0.2",))
    require_safe_binding("proxy", "127.0.0.1", ("lab.example",), ("127.0.0.1",))
    with pytest.raises(UnusableSettings, match=r"web\.proxies is '127\.0\.0\.1'"):
        require_safe_binding("none", "127.0.0.1", (), ("127.0.0.1",))


@pytest.mark.parametrize("mode", ["None", "off", "OIDC", ""])
def test_no_word_for_a_mode_means_none_by_accident(mode: str) -> None:
    with pytest.raises(UnusableSettings, match=r"auth\.mode"):
        load(document={"auth": {"mode": mode}})
