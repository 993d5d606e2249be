"""An order that is sent again with its key begins nothing: whoever heard no answer may ask again."""

from __future__ import annotations

import hashlib
import uuid
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Final

from teachpath.errors import Conflict, NotFound
from teachpath.records import Job

if TYPE_CHECKING:
    from teachpath.io.store.store import Store

DIGITS: Final = 16
STATION_FIELDS: Final = frozenset({"upload"})  # by the station: another one when the order comes again
ORDER_KEY: Final = "ordered"  # holds what the sender ordered, of a request to which the station has added more


def job_id(task: str, kind: str, submitter: str, idempotency_key: str) -> str:
    """Return the id of a job: the same for an order with the same key, without a key always another one."""
    if not idempotency_key:
        return f"{kind}-{uuid.uuid4().hex[:12]}"
    words = "\n".join((task, kind, submitter, idempotency_key))
    return f"{kind}-{hashlib.sha256(words.encode(errors='surrogatepass')).hexdigest()[:DIGITS]}"


def begun_by(
    store: Store, task: str, kind: str, request: dict[str, Any], submitter: str, idempotency_key: str
) -> Job | None:
    """Return the job that an order with this key has begun; raises Conflict where it was another order."""
    with suppress(NotFound):
        if idempotency_key:
            return _require_same(store.job(job_id(task, kind, submitter, idempotency_key)), request)
    return None


def _require_same(job: Job, request: dict[str, Any]) -> Job:
    if _ordered(job.request.get(ORDER_KEY, job.request)) != _ordered(request.get(ORDER_KEY, request)):
        raise Conflict(
            f"this Idempotency-Key has begun job {job.id}, by another order; send a new key with each order, and the "
            "same one only with the same order again"
        )
    return job


def _ordered(value: Any) -> Any:
    """Return what the sender said of an order, in the form that it has in the database."""
    if isinstance(value, dict):
        return {name: _ordered(each) for name, each in value.items() if name not in STATION_FIELDS}
    return [_ordered(each) for each in value] if isinstance(value, (list, tuple)) else value
