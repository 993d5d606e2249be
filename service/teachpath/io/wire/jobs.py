"""What is told of background work."""

from __future__ import annotations

from teachpath.records import Job
from teachpath_proto import job_pb2


def encode_progress(job: Job) -> bytes:
    """Return the message that tells of a job's progress."""
    return job_pb2.JobProgress(
        id=job.id, kind=job.kind, state=job.state.value, fraction=job.fraction, message=job.message
    ).SerializeToString()
