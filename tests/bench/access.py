"""What it adds to a request that a station asks who sends it."""

import asyncio
import tempfile
import time
from pathlib import Path

from httpx import ASGITransport, AsyncClient

from teachpath.access.tokens import new_token
from teachpath.app import Station
from teachpath.records import Capability
from tests.bench.report import Figure, print_report
from tests.contract.stations import station_in

REQUESTS = 400
ALLOWED = 1.0  # [ms] more of the processor


def measure() -> list[Figure]:
    """Return the milliseconds of a small answer without and with a token, and what the token adds."""
    means = {}
    for mode in ("none", "token"):
        with (
            tempfile.TemporaryDirectory(prefix="teachpath-bench-") as folder,
            station_in(Path(folder), auth={"mode": mode}) as station,
        ):
            means[mode] = asyncio.run(_read(station))
    added = means["token"] - means["none"]
    return [
        Figure("a small answer, of the processor, without asking who sends the request", (means["none"],), "ms"),
        Figure("  with a token", (means["token"],), "ms"),
        Figure(f"  the token adds (allowed {ALLOWED:g} ms)", (added,), "ms"),
    ]


async def _read(station: Station) -> float:
    """Return the processor's time for a request [ms]; threads of the station at rest take little beside it."""
    token, kept = new_token("bench", (Capability.VIEW,), now_ns=time.time_ns(), days=1.0)
    station.store.access_tokens.add(kept)
    station.access.refresh()
    headers = {"Authorization": f"Bearer {token}"}
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
