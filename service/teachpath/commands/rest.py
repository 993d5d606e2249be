"""The commands' own way to a running service: its REST API, with progress shown while jobs run."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import httpx

from teachpath.errors import TeachpathError, Unreachable

POLL = 0.1  # [s]
ENDED_JOBS = ("succeeded", "failed", "cancelled")
ENDED_EXECUTIONS = ("ended", "faulted", "idle")


class Api:
    """A service's REST API."""

    def __init__(self, url: str) -> None:
        self._http = httpx.Client(base_url=f"{url.rstrip('/')}/api/v1", timeout=60.0, trust_env=False)
        self._url = url

    def __enter__(self) -> Api:
        return self

    def __exit__(self, *_: object) -> None:
        self._http.close()

    def call(self, method: str, resource: str, body: dict[str, Any] | None = None, **more: Any) -> Any:
        """Call a resource and return its JSON.

        Raises:
            Unreachable: no service answers at this address.
            TeachpathError: the service refused, with its sentence.
        """
        try:
            response = self._http.request(method, resource, json=body, **more)
        except httpx.HTTPError as error:
            raise Unreachable(f"no service at {self._url} ({error}); start it with: teachpath serve") from None
        if response.is_error:
            raise TeachpathError(_detail(response))
        return response.json()

    def follow_job(self, job: dict[str, Any], show: Callable[[float, str], None]) -> dict[str, Any]:
        """Wait for a job, showing its progress, and return it; raises TeachpathError when it did not succeed."""
        while job["state"] not in ENDED_JOBS:
            show(job["fraction"], job["message"] or job["state"])
            time.sleep(POLL)
            job = self.call("GET", f"/jobs/{job['id']}")
        if job["state"] != "succeeded":
            raise TeachpathError(f"{job['kind']} {job['state']}: {job['message']}")
        show(1.0, "done")
        return job

    def follow_execution(self, execution: dict[str, Any], show: Callable[[float, str], None]) -> dict[str, Any]:
        """Wait for an execution to end and return it; raises TeachpathError when the arm faulted."""
        while (status := execution["status"])["state"] not in ENDED_EXECUTIONS:
            show(status["progress"], ": ".join(filter(None, (status["state"], status["reason"]))))
            time.sleep(POLL)
            execution = self.call("GET", f"/executions/{execution['id']}")
        if status["state"] == "faulted":
            raise TeachpathError(f"the execution faulted: {status['reason']}")
        show(1.0, status["state"])
        return execution


def _detail(response: httpx.Response) -> str:
    try:
        detail = response.json()["detail"]
    except (ValueError, KeyError, TypeError):
        return f"the service answered {response.status_code}: {response.text[:200]}"
    return detail if isinstance(detail, str) else f"the service refused the request: {detail}"
