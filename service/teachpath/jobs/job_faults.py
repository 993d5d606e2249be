"""What a job keeps of the error by which it failed."""

from __future__ import annotations

from typing import Any

from teachpath.errors import LearningFailed, PathRefused, TeachpathError
from teachpath.io.documents import to_document


def disk_sentence(error: OSError) -> str:
    """Say to the operator what the disk refused."""
    from teachpath.io.store.faults import storage_fault  # not where there is no store

    return str(storage_fault(error, "the data folder") or f"this is a fault of teachpath, please report it: {error!r}")


def evidence_of(error: TeachpathError) -> dict[str, Any]:
    """Return the records that an error carries, as a job keeps them."""
    if isinstance(error, PathRefused) and error.failure is not None:
        return {"failure": to_document(error.failure)}
    if isinstance(error, LearningFailed):
        return {"demonstration": error.demonstration}
    return {}
