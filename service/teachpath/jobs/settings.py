"""How background work is done, and what it may take."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Annotated, Final

from annotated_types import Ge, Gt, Le

from teachpath.errors import UnusableSettings

LOCAL_EXECUTOR: Final = "local"
CLUSTER: Final = re.compile(r"dask(\+tls)?://(\[[0-9a-fA-F:]+\]|[\w.-]+):(\d{1,5})", re.ASCII)


def check_executor(executor: str) -> None:
    """Raise UnusableSettings when a setting `jobs.executor` is no place where jobs can be done."""
    if executor != LOCAL_EXECUTOR and not CLUSTER.fullmatch(executor):
        raise UnusableSettings(
            f"setting jobs.executor is {executor!r}; it should be local, or dask://HOST:PORT of a Dask scheduler (over "
            "TLS dask+tls://HOST:PORT)"
        )


@dataclass(frozen=True)
class JobSettings:
    """How background work is done."""

    # where learning and planning jobs are done: local, or dask://HOST:PORT of a Dask scheduler (over TLS dask+tls://)
    executor: str = LOCAL_EXECUTOR
    # of them, jobs on a cluster at a time
    cluster_jobs: Annotated[int, Ge(1), Le(1000)] = 4
    # how often a job is begun anew after its process died
    attempts: Annotated[int, Ge(1), Le(10)] = 3
    # jobs that may wait or run at a time
    max_queued: Annotated[int, Ge(1)] = 100
    # of them, jobs that came from one address
    max_queued_by_one: Annotated[int, Ge(1)] = 25
    # bytes of memory that learning or planning may take beside its libraries, where the system can limit it
    max_memory: Annotated[int, Ge(67108864)] = 4294967296
    # [s] that learning or planning may take
    max_duration: Annotated[float, Gt(0)] = 3600.0
    # bytes of memory that reading and writing files may take, likewise
    max_file_memory: Annotated[int, Ge(67108864)] = 1073741824
    # [s] that reading and writing a file may take
    max_file_duration: Annotated[float, Gt(0)] = 600.0
    # exports that may wait or run at a time, half as many for one address
    max_exports: Annotated[int, Ge(2)] = 8
