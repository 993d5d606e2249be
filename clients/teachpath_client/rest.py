"""The station's REST API, as far as the clients need it."""

from __future__ import annotations

from typing import Any

import httpx

from teachpath_client.errors import ClientError


class Station:
    """A station's REST API at `url`; use it as a context manager.

    Every method raises ClientError with the station's own sentence when a call is refused.
    """

    def __init__(self, url: str, *, timeout: float = 30.0) -> None:
        self._http = httpx.Client(base_url=f"{url.rstrip('/')}/api/v1", timeout=timeout, trust_env=False)

    def __enter__(self) -> Station:
        return self

    def __exit__(self, *_: object) -> None:
        self._http.close()

    def call(self, method: str, resource: str, body: dict[str, Any] | None = None) -> Any:
        """Call a resource, e.g. `call("GET", "/tasks")`, and return its JSON."""
        return self._send(method, resource, body).json()

    def recording(self, demonstration: str) -> bytes:
        """Return the MCAP file of a demonstration."""
        return self._send("GET", f"/demonstrations/{demonstration}/recording", None).content

    def _send(self, method: str, resource: str, body: dict[str, Any] | None) -> httpx.Response:
        try:
            response = self._http.request(method, resource, json=body)
        except httpx.HTTPError as error:
            raise ClientError(f"no station at {self._http.base_url}: is `teachpath serve` running? ({error})") from None
        if response.is_error:
            raise ClientError(_detail(response))
        return response


def _detail(response: httpx.Response) -> str:
    try:
        return str(response.json()["detail"])
    except (ValueError, KeyError, TypeError):
        return f"the station answered {response.status_code}: {response.text[:200]}"
