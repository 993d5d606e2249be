"""Requests that are under way at a time: of one subject, and of all, so that a stop always finds a connection."""

import asyncio
from typing import Any

import httpx
import pytest
from starlette.responses import PlainTextResponse
from starlette.types import Receive, Scope, Send

from teachpath.access.access import Access
from teachpath.access.memory_people import MemoryPeople
from teachpath.access.memory_tokens import MemoryTokens
from teachpath.access.settings import AuthSettings, LimitSettings
from teachpath.api.limits import LimitSubjects

CONNECTIONS = 20
KEPT_ENTRIES = 2
STOPS = ("/api/v1/stop", "/api/v1/executions/e/stop")


class Waiting:
    """An application that answers when it is let go, behind the limits."""

    def __init__(self, mode: str, **limits: Any) -> None:
        self.under_way, self.go_on = 0, asyncio.Event()
        access = Access(AuthSettings(mode), MemoryTokens(), MemoryPeople())  # type: ignore[arg-type]
        self._limited = LimitSubjects(
            self._answer, access=access, settings=LimitSettings(**limits), max_connections=CONNECTIONS
        )

    async def ask(self, method: str, path: str, address: str = "192.168.7.9") -> httpx.Response:
        transport = httpx.ASGITransport(self._limited, client=(address, 51234))
        async with httpx.AsyncClient(transport=transport, base_url="http://here") as client:
            return await client.request(method, path)

    async def hold(self, count: int, path: str, address: str = "192.168.7.9") -> list[asyncio.Task[httpx.Response]]:
        """Ask so often, and wait until all of it is under way."""
        aim = self.under_way + count
        held = [asyncio.create_task(self.ask("POST", path, address)) for _ in range(count)]
        while self.under_way < aim:
            await asyncio.sleep(0)
        return held

    async def _answer(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["path"] not in STOPS:
            self.under_way += 1
            await self.go_on.wait()
        await PlainTextResponse("done")(scope, receive, send)


@pytest.mark.parametrize(
    ("path", "limits"), [("/api/v1/tasks", {"max_requests": 3}), ("/api/v1/uploads", {"max_uploads": 3})]
)
def test_so_many_requests_of_one_subject_are_under_way(path: str, limits: dict[str, int]) -> None:
    async def story() -> None:
        app = Waiting("token", **limits)
        held = await app.hold(3, path)
        refused = await app.ask("POST", path)
        assert (refused.status_code, refused.headers["retry-after"]) == (429, "1")
        assert "of address 192.168.7.9 are open" in refused.json()["detail"]
        for stop in STOPS:
            assert (await app.ask("POST", stop)).status_code == 200
        held += await app.hold(3, path, "192.168.7.10")
        app.go_on.set()
        assert {answer.status_code for answer in await asyncio.gather(*held)} == {200}
        assert (await app.ask("POST", path)).status_code == 200

    asyncio.run(story())


@pytest.mark.parametrize("mode", ["none", "token"])
def test_connections_are_kept_for_stops(mode: str) -> None:
    async def story() -> None:
        app = Waiting(mode)
        held = await app.hold(CONNECTIONS - KEPT_ENTRIES, "/api/v1/tasks")
        refused = await app.ask("GET", "/api/v1/tasks", "192.168.7.10")
        assert (refused.status_code, refused.headers["retry-after"]) == (503, "1")
        assert "kept for those that stop the arm" in refused.json()["detail"]
        for stop in STOPS:
            assert (await app.ask("POST", stop)).status_code == 200
        app.go_on.set()
        await asyncio.gather(*held)
        assert (await app.ask("GET", "/api/v1/tasks")).status_code == 200

    asyncio.run(story())


def test_where_nobody_is_asked_only_all_together_are_limited() -> None:
    async def story() -> None:
        app = Waiting("none", max_requests=1, request_burst=1, request_rate=1e-6)
        held = await app.hold(5, "/api/v1/tasks")
        app.go_on.set()
        assert {answer.status_code for answer in await asyncio.gather(*held)} == {200}

    asyncio.run(story())
