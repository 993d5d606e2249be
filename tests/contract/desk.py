"""A client at the REST API of a station in this process, and the files that it sends."""

import asyncio
import io
import queue
from pathlib import Path
from typing import Any

import numpy as np
from fastapi.routing import iter_route_contexts
from httpx import ASGITransport, AsyncClient, Response
from pydantic import TypeAdapter
from starlette.routing import Match

from teachpath.api.problems import WORDS
from teachpath.app import Station
from tests.waiting import HANG

API = "/api/v1"


class Desk:
    """A station and a client that speaks to it."""

    def __init__(self, station: Station, loop: asyncio.Runner) -> None:
        self.station, self._loop = station, loop
        self.described = 0  # answers that were held against their description
        app = ASGITransport(station.web, raise_app_exceptions=False)
        self._client = AsyncClient(transport=app, base_url="http://127.0.0.1:8765")
        self._operations = _responses(station)
        self.data_dir = Path(station.settings.store.data_dir)
        self._news: queue.SimpleQueue[bytes] = queue.SimpleQueue()
        station.bus.subscribe(station.keys.job("*"), lambda _, payload: self._news.put(payload))

    def send(self, method: str, address: str, **options: Any) -> Response:
        answer = self._loop.run(self._client.request(method, address, **options))
        self._client.cookies.clear()  # each request stands for itself
        self._check_described(answer)
        return answer

    def _check_described(self, answer: Response) -> None:
        """Check that an answer is one that the description of the API gives the operation, and holds exactly that."""
        scope = {"type": "http", "method": answer.request.method, "path": answer.request.url.path}
        routes = iter_route_contexts(self.station.web.routes)
        route = next((r for r in routes if r.matches(scope)[0] is Match.FULL), None)
        if route is None or route.name not in self._operations or answer.text == "Invalid host header":
            return
        if answer.status_code == 405:  # the address is another operation's
            return
        promised = self._operations[route.name].get(str(answer.status_code))
        assert promised is not None, f"{route.name} does not say that it answers {answer.status_code}: {answer.text}"
        if answer.content:
            assert answer.headers["content-type"].partition(";")[0] in promised["content"]
        if answer.is_error:
            assert answer.json()["error"] in WORDS
        assert ("location" in answer.headers) == ("Location" in promised.get("headers", {}))
        if answer.is_success and (described := getattr(route, "response_model", None)) is not None:
            self.described += 1
            model, document = TypeAdapter(described), answer.json()
            assert model.dump_python(model.validate_python(document), mode="json") == document

    def get(self, resource: str, **options: Any) -> Response:
        return self.send("GET", API + resource, **options)

    def put(self, resource: str, body: Any) -> Response:
        return self.send("PUT", API + resource, json=body)

    def post(self, resource: str, body: Any = None, **options: Any) -> Response:
        return self.send("POST", API + resource, **({"json": body} | options))

    def upload(self, task: str, content: Any, **query: Any) -> Response:
        return self.post(f"/tasks/{task}/demonstrations", json=None, content=content, params=query)

    def import_(self, task: str, content: Any, **query: Any) -> list[dict[str, Any]]:
        """Import a file, and return the demonstrations that were made of it."""
        job = self.ended(self.upload(task, content, **query))
        assert job["state"] == "succeeded", job["message"]
        first, last = map(int, job["outcome"].split("-"))
        made: list[dict[str, Any]] = self.get(f"/tasks/{task}/demonstrations").json()
        return [d for d in made if first <= d["number"] <= last]

    def ended(self, accepted: Response) -> dict[str, Any]:
        """Wait for the job that was accepted to end."""
        assert accepted.status_code == 202, accepted.text
        assert accepted.headers["location"] == f"{API}/jobs/{accepted.json()['id']}"
        return self.job_ended(accepted.json()["id"])

    def job_ended(self, key: str) -> dict[str, Any]:
        """Wait for a job to end."""
        while True:
            job: dict[str, Any] = self.get(f"/jobs/{key}").json()
            if job["finished_ns"]:
                return job
            self._news.get(timeout=HANG)


def _responses(station: Station) -> dict[str, dict[str, Any]]:
    """Return what the description of the API says of the answers of each operation, by its id."""
    methods = [operation for path in station.web.openapi()["paths"].values() for operation in path.values()]
    return {operation["operationId"]: operation["responses"] for operation in methods}


def refused(response: Response, status: int, sentence: str) -> None:
    """Check that a refusal has its status and a sentence, on one line, that holds `sentence`."""
    assert response.status_code == status, response.text
    detail = response.json()["detail"]
    assert isinstance(detail, str)
    assert sentence in detail, detail
    assert len(detail) > 15
    assert "\n" not in detail


def csv(points: int = 60, *, step: float = 0.01, rise: float = 0.0) -> str:
    rows = [f"{i * 0.02},{0.4 + step * i},{0.1 * np.sin(i / 20):.6f},{0.6 + rise * i}\n" for i in range(points)]
    return "t,x,y,z\n" + "".join(rows)


def npy(values: Any) -> bytes:
    out = io.BytesIO()
    np.save(out, values)
    return out.getvalue()
