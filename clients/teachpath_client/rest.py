"""Requests to a station's REST API, and its answers as records."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from typing import Any, Self, TypeVar

import httpx

from teachpath_client.errors import ClientError, NotStopped, Refused, Unreachable
from teachpath_client.models import Refusal
from teachpath_client.structuring import structured
from teachpath_proto.authorities import authorities_folder, trusted_authorities
from teachpath_proto.tokens import checked_token, find_token

T = TypeVar("T")

LOCAL_ADDRESS = "http://127.0.0.1:8765"
LEASE_HEADER = "Teachpath-Lease"
UNTRUSTED_ERROR = "CERTIFICATE_VERIFY_FAILED"  # in the text of an error of TLS
PAGE_SIZE = 500  # entries of a list that are asked for at a time, as many as a station gives
IDLE_TIMEOUT = 2.0  # [s] after which no connection is used again; a service closes those that are idle for 5 s
STOP_TIMEOUT = 5.0  # [s] for the answer to a stop; a station that lives says within 2 s that nothing was confirmed


class Rest:
    """A station's REST API; use it as a context manager.

    Args:
        url: of the station.
        timeout: [s] for an answer.
        operator: your name, for the journal.
        lease: token of the control over the arm, where somebody has taken it.
        token: that says who you are, where the station asks; unless given, that of the variable TEACHPATH_TOKEN, or of
            this user's file for the station (`teachpath token create --keep`).

    Raises:
        ClientError: that token cannot be used.
    """

    def __init__(
        self, url: str = LOCAL_ADDRESS, *, timeout: float = 60.0, operator: str = "", lease: str = "", token: str = ""
    ) -> None:
        self.url: str = url.rstrip("/")
        self._operator = operator
        self.token: str = _token(self.url, token)
        headers = {"Teachpath-Operator": operator} if operator else {}
        if self.token:
            headers["Authorization"] = f"Bearer {self.token}"
        trusted = trusted_authorities(self.url) or True
        self._http = httpx.Client(
            base_url=f"{self.url}/api/v1",
            timeout=timeout,
            headers=headers,
            verify=trusted,
            trust_env=False,
            limits=httpx.Limits(keepalive_expiry=IDLE_TIMEOUT),
        )
        self.set_lease(lease)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._http.close()

    def set_lease(self, token: str) -> None:
        """Command the arm by this lease from now on; an empty token: by none."""
        self._http.headers.pop(LEASE_HEADER, None)
        if token:
            self._http.headers[LEASE_HEADER] = token

    @property
    def _has_lease(self) -> bool:
        return LEASE_HEADER in self._http.headers

    def call(
        self,
        method: str,
        resource: str,
        body: Mapping[str, Any] | None = None,
        *,
        content: bytes | None = None,
        **query: Any,
    ) -> Any:
        """Call a resource that has no method here, e.g. `call("GET", "/calibrations")`, and return its JSON.

        Raises:
            Unreachable: no station answers.
            Refused: the station refused, with its sentence.
        """
        answer = self._send(method, resource, body, content, query)
        return answer.json() if answer.content else None

    def _ask(
        self,
        kind: Callable[..., T],
        method: str,
        resource: str,
        body: Mapping[str, Any] | None = None,
        *,
        content: bytes | None = None,
        **query: Any,
    ) -> T:
        """Call a resource and return its answer as a record; raises as `call`."""
        return self._record(kind, method, resource, self._send(method, resource, body, content, query).json())

    def pages(self, resource: str, *, limit: int | None = None, **query: Any) -> Iterator[list[Any]]:
        """Yield the pages of a list, each as JSON when it is asked for; together at most `limit` entries.

        What is added meanwhile neither doubles an entry nor hides one. Raises as `call`.
        """
        left = float("inf") if limit is None else limit
        while left > 0:
            answer = self._send("GET", resource, None, None, query | {"limit": int(min(PAGE_SIZE, left))})
            entries = answer.json()
            yield entries
            following = answer.links.get("next")
            if following is None:
                return
            left -= len(entries)
            query |= {"after": httpx.URL(following["url"]).params["after"]}

    def _list(self, kind: Callable[..., T], resource: str, limit: int | None = None, **query: Any) -> list[T]:
        """Return a list as records, all of it or its first entries; raises as `call`."""
        entries = (entry for page in self.pages(resource, limit=limit, **query) for entry in page)
        return [self._record(kind, "GET", resource, entry) for entry in entries]

    def _stop(self, kind: Callable[..., T], resource: str) -> T:
        """Send a stop and return the record that confirms it; raises NotStopped, or Refused."""
        try:
            answer = self._send("POST", resource, None, None, {}, timeout=STOP_TIMEOUT)
        except Unreachable as error:
            if UNTRUSTED_ERROR in str(error):
                self._stop_whoever_answers(resource)
            raise NotStopped(f"NOT STOPPED: {error}; press the emergency stop of the arm") from None
        except Refused as refused:
            if refused.refusal.error == "NotStopped":
                raise NotStopped(str(refused)) from None
            raise
        return self._record(kind, "POST", resource, answer.json())

    def _stop_whoever_answers(self, resource: str) -> None:
        """Send a stop to a station whose certificate is not trusted, without a token; its answer proves nothing."""
        with suppress(httpx.HTTPError):
            httpx.post(f"{self.url}/api/v1{resource}", verify=False, timeout=STOP_TIMEOUT, trust_env=False)

    @staticmethod
    def _record(kind: Callable[..., T], method: str, resource: str, document: Any) -> T:
        try:
            return structured(kind, document)
        except ValueError as error:
            raise ClientError(f"{method} {resource}: {error}; is the station of the same version?") from None

    def _download(self, resource: str, **query: Any) -> bytes:
        return self._send("GET", resource, None, None, query).content

    def _send(
        self,
        method: str,
        resource: str,
        body: Mapping[str, Any] | None,
        content: bytes | None,
        query: dict[str, Any],
        *,
        timeout: float | None = None,
    ) -> httpx.Response:
        wait = self._http.timeout if timeout is None else timeout
        parameters = query or None  # {} would take a query out of the address
        try:
            answer = self._http.request(method, resource, json=body, content=content, params=parameters, timeout=wait)
        except httpx.HTTPError as error:
            raise Unreachable(_unreachable(self.url, error)) from None
        if answer.is_error:
            raise Refused(answer.status_code, _refusal(answer))
        return answer


def _token(url: str, given: str) -> str:
    try:
        return checked_token(given, "the token that was given") if given else find_token(url)
    except ValueError as error:
        raise ClientError(str(error)) from None


def _unreachable(url: str, error: Exception) -> str:
    if UNTRUSTED_ERROR in str(error):
        return (
            f"the certificate of {url} is not trusted here ({error}); put the authority.pem of the station, which its "
            f"page offers at /authority, into {authorities_folder()}"
        )
    return f"no station at {url} ({error}); start it with: teachpath serve"


def _refusal(answer: httpx.Response) -> Refusal:
    try:
        return structured(Refusal, answer.json())
    except (ValueError, TypeError, AttributeError):
        sentence = f"the station answered {answer.status_code}: {answer.text[:200]}"
        return Refusal("about:blank", answer.reason_phrase, answer.status_code, sentence, "")
