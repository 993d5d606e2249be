"""Rows to store: a demonstration, a job, what was learned."""

from dataclasses import replace

import numpy as np

from teachpath.records import (
    Calibration,
    Cluster,
    Demonstration,
    Job,
    JobState,
    Learned,
    Score,
    StreamStatistics,
    Verdict,
)
from tests.unit.io.test_documents import a_path


def demonstration(key: str, **changes: object) -> Demonstration:
    values: dict[str, object] = {
        "id": key,
        "task": "t",
        "number": 0,
        "source": "glove",
        "calibration": Calibration("identity"),
        "created_ns": 1,
        "duration": 1 / 3,
        "samples": 5,
        "grasp": 1,
        "release": 4,
        "verdict": Verdict.CLEAN,
        "statistics": StreamStatistics(received=5),
        "recording": f"t/{key}.mcap",
    }
    return Demonstration(**{**values, **changes})  # type: ignore[arg-type]


def a_job(key: str = "learn-1", **changes: object) -> Job:
    return replace(Job(key, "t", "learn", {}, JobState.QUEUED, 0.0, "", "", 0, 1, 0), **changes)  # type: ignore[arg-type]


def learned() -> Learned:
    cluster = Cluster(1, ("d",), (Score("d", -1 / 3, 1, True),), (0.1, 0.2), "one")
    paths = (replace(a_path(), cluster=1), replace(a_path(), cluster=2))
    return Learned(
        "default", ("d",), np.array([[0.0, 1.0, 1 / 3, 2.0]]), 0.06, (cluster, replace(cluster, index=2)), paths
    )
