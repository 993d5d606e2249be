"""What it adds to a request that a station asks who sends it."""

import asyncio
import tempfile
import time
from pathlib import Path

from httpx import ASGITransport, AsyncClient

from teachpath.access.passwords import hash_password
from teachpath.access.tokens import new_token
from teachpath.api.session_cookie import LOOPBACK_COOKIE
from teachpath.app import Station
from teachpath.records import Capability, Person
from tests.bench.report import Figure, print_report
from tests.contract.stations import station_in

REQUESTS = 400
ALLOWED_MS = 1.0  # [ms] more of the processor
PASSWORD = "four words together"


def measure() -> list[Figure]:
    """Return the milliseconds of a small answer without asking, with a token and in a session, and what these add."""
    means = {}
    for way, mode in (("none", "none"), ("token", "token"), ("session", "token")):
        with (
            tempfile.TemporaryDirectory(prefix="teachpath-bench-") as folder,
            station_in(Path(folder), auth={"mode": mode}) as station,
        ):
            means[way] = asyncio.run(_read(station, _token(station) if way != "session" else _session(station)))
    return [
        Figure("a small answer, of the processor, without asking who sends the request", (means["none"],), "ms"),
        Figure("  with a token", (means["token"],), "ms"),
        Figure(f"  the token adds (allowed {ALLOWED_MS:g} ms)", (means["token"] - means["none"],), "ms"),
        Figure("  in a session", (means["session"],), "ms"),
        Figure(f"  the session adds (allowed {ALLOWED_MS:g} ms)", (means["session"] - means["none"],), "ms"),
    ]


def _token(station: Station) -> dict[str, str]:
    token, kept = new_token("bench", (Capability.VIEW,), now_ns=time.time_ns(), days=1.0)
    station.store.access_tokens.add(kept)
    station.access.refresh()
    return {"Authorization": f"Bearer {token}"}


def _session(station: Station) -> dict[str, str]:
    now = time.time_ns()
    station.store.people.add(Person("bench", (Capability.VIEW,), hash_password(PASSWORD, "bench"), now, now))
    station.access.refresh()
    secret, _ = station.access.sessions.sign_in("bench", PASSWORD, "127.0.0.1")
    return {"Cookie": f"{LOOPBACK_COOKIE}={secret}"}


async def _read(station: Station, headers: dict[str, str]) -> float:
    """Return the processor's time for a request [ms]; threads of the station at rest take little beside it."""
    transport = ASGITransport(station.web)
    async with AsyncClient(transport=transport, base_url="http://127.0.0.1:8765", headers=headers) as client:
        for _ in range(20):
            (await client.get("/api/v1/calibrations")).raise_for_status()
        begin = time.process_time()
        for _ in range(REQUESTS):
            await client.get("/api/v1/calibrations")
        return 1e3 * (time.process_time() - begin) / REQUESTS


if __name__ == "__main__":
    print_report("Who sends a request", measure())
